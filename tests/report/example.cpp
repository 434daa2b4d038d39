#include "tests/report/example.h"
#include <cmath>
#include <limits>

namespace chiaro::test {
namespace {

// A room of two colours with a bright lamp, brightened by noise of about 20 %.
report::Image room(const std::string& name, uint32_t width, uint32_t height, uint64_t seed, float gain) {
    report::Image image{name, width, height, {}};
    image.rgb.reserve(std::size_t(width) * height * 3);
    uint64_t state = seed * 0x9e3779b97f4a7c15u + 1;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            const float noise = seed == 0 ? 1.0f : 0.8f + 0.4f * float(state >> 40) * 0x1p-24f;
            const float u = (float(x) + 0.5f) / float(width), v = (float(y) + 0.5f) / float(height);
            const float lamp = std::hypot(u - 0.5f, v - 0.2f) < 0.1f ? 20.0f : 0.0f;
            const float light = gain * noise * (0.15f + 0.5f * u * (1 - v)) + lamp;
            image.rgb.insert(image.rgb.end(), {light * (1.2f - u), light * 0.8f, light * (0.3f + u)});
        }
    return image;
}

} // namespace

report::Report exampleTexts() {
    report::Report r;
    r.title = "@cornell-spheres at equal time";
    r.version = "chiaro 0.1.0";
    r.command = "chiaro compare @cornell-spheres -i path,path:nee=off,normals --equal time --time 10s --seeds 4 -o out/compare";
    r.machine = "2 threads, avx512, Embree 3.13.5";
    r.settings = {{"scene", "@cornell-spheres"}, {"held equal", "time, 10 s each"}, {"seeds", "4"},      {"maximal depth", "unlimited"},
                  {"sampler", "sobol"},          {"filter", "blackman-harris"},     {"size", "1280x720"}};
    r.notes = {"exposure -3.1 was chosen by itself; keep it with --exposure -3.1",
               "the reference is the mean of 16 independent renders by path, with an error of 0.3 %"};
    r.exposure = -0.5;
    return r;
}

void describe(report::Entry& e, report::Standing standing, std::size_t number) {
    using enum report::Standing;
    e.standing = standing;
    e.seconds = 10 + 0.1 * double(number);
    e.prepassSeconds = number == 1 ? 2.5 : 0;
    e.spp = 16.0 * double(number + 1);
    e.seeds = 4;
    switch (standing) {
    case agrees: e.verdict = "no difference to the reference beyond noise (mean -0.1 % +- 0.2 %)"; break;
    case cannotTell: e.verdict = "too noisy to tell: a difference of 1.5 % would not be seen"; break;
    case biased: e.verdict = "mean +2.1 % +- 0.3 % above the reference in 14 of 64 tiles"; break;
    case missesPaths: e.verdict = "leaves out L S+ D E; agrees on the paths that it covers"; break;
    case debug: e.verdict = "a debug view: it shows no light"; break;
    case differs: e.verdict = "differs in 30 of 64 tiles, by up to 40 %"; break;
    case reference: e.verdict = "what the others are measured against"; break;
    case unjudged: break;
    }
    if (e.covers.empty()) e.covers = "L (D|G|S)* E";
}

void addCurves(report::Report& r, std::size_t entries) {
    for (std::size_t i = 0; i < entries; ++i) {
        report::Curve c{uint32_t(i), {}, i == 2 ? -0.21 : -0.5 + 0.01 * double(i), 0.02};
        for (int k = 0; k < 8; ++k) {
            const double spp = std::ldexp(1.0, k),
                         error = (0.5 + 0.3 * double(i)) * std::pow(spp, *c.slope) * (1 + 0.05 * std::sin(3.0 * k));
            c.points.push_back({0.08 * spp * double(i + 1), spp, error, 0.9 * error, 1.12 * error});
        }
        r.curves.push_back(std::move(c));
    }
    for (const double error : {0.3, 0.1, 0.03, 0.01}) {
        report::TimeToError row{error, {}};
        for (std::size_t i = 0; i < entries; ++i) {
            const double seconds = 0.08 * double(i + 1) * std::pow(error / (0.5 + 0.3 * double(i)), 1 / *r.curves[i].slope);
            row.cells.push_back({i == 2 && error < 0.1 ? std::numeric_limits<double>::quiet_NaN() : seconds, seconds > 10});
        }
        r.timeToError.push_back(std::move(row));
    }
}

report::Report exampleReport(uint32_t width, uint32_t height) {
    using enum report::Standing;
    report::Report r = exampleTexts();
    const char* names[] = {"path", "path:nee=off", "radiosity", "reference"};
    const report::Standing standings[] = {agrees, cannotTell, missesPaths, reference};
    const float gains[] = {1, 1, 0.9f, 1};
    for (std::size_t i = 0; i < 4; ++i) {
        report::Entry e;
        e.name = names[i];
        e.source = i == 3 ? "reference" : "integrator";
        e.file = std::string(names[i]) + ".exr";
        e.command = std::string("chiaro render @cornell-spheres -i ") + names[i] + " -o " + e.file;
        e.picture = room(names[i], width, height, i == 3 ? 0 : i + 1, gains[i]);
        e.layers = {room("bounce 1", width, height, i + 1, 0.5f * gains[i])};
        describe(e, standings[i], i);
        r.entries.push_back(std::move(e));
    }
    r.reference = 3;
    for (std::size_t i = 0; i < 3; ++i) {
        report::Entry& e = r.entries[i];
        report::Map flip{"FLIP", "The difference that a person sees: 0 none, 1 the largest.", {}, 0, 1, false};
        report::Map z{"z-score", "The difference in standard errors: beyond 4 it is no noise.", {}, -6, 6, true};
        for (std::size_t k = 1; k < e.picture.rgb.size(); k += 3) {
            const float d = e.picture.rgb[k] - r.entries[3].picture.rgb[k];
            flip.values.push_back(std::min(1.0f, std::abs(d) * 4));
            z.values.push_back(d * 30);
        }
        e.maps = {std::move(flip), std::move(z)};
        e.metrics = {{"relMSE", 0.004 * double(i + 1), 0.0003, true},
                     {"FLIP", 0.03 * double(i + 1), 0.001, true},
                     {"mean", 0.31, 0.002, true, false}};
    }
    addCurves(r, 3);
    return r;
}

} // namespace chiaro::test
