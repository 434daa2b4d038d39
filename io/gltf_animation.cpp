#include "io/gltf_animation.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

constexpr std::array<const char*, 3> paths = {"translation", "rotation", "scale"};
constexpr uint64_t freeNumbers = uint64_t(1) << 26; // of keys, whatever the size of the buffers

double normOf(const std::array<double, 4>& q) { return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]); }
double dotOf(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

std::array<double, 4> mix(const std::array<double, 4>& a, double u, const std::array<double, 4>& b, double v) {
    std::array<double, 4> r;
    for (size_t i = 0; i < 4; ++i) r[i] = u * a[i] + v * b[i];
    return r;
}

// Along the shorter great arc (glTF 2.0.1, appendix C.4).
std::array<double, 4> slerp(std::array<double, 4> a, std::array<double, 4> b, double f) {
    a = mix(a, 1 / normOf(a), a, 0);
    b = mix(b, (dotOf(a, b) < 0 ? -1 : 1) / normOf(b), b, 0);
    const double angle = std::acos(std::min(dotOf(a, b), 1.0)), sine = std::sin(angle);
    return sine < 1e-6 ? mix(a, 1 - f, b, f) : mix(a, std::sin((1 - f) * angle) / sine, b, std::sin(f * angle) / sine);
}

// Which are meant: by name, by number, "all", "none"; empty: the first. Throws Exit::usage.
std::vector<size_t> chosen(const GltfFile& file, const std::string& wanted) {
    const json& animations = list(file, "animations");
    std::vector<size_t> all(animations.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = i;
    std::vector<std::string> names;
    for (size_t i = 0; i < all.size(); ++i) {
        names.push_back(animations[i].value("name", std::string()));
        if (!wanted.empty() && names.back() == wanted) return {i};
    }
    if (wanted == "none") return {};
    if (wanted == "all") return all;
    if (wanted.empty()) return all.empty() ? all : std::vector<size_t>{0};
    size_t number = 0;
    const auto [end, failed] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (failed == std::errc() && end == wanted.data() + wanted.size() && number < all.size()) return {number};
    if (all.empty()) throw Error(Exit::usage, printable(fmt::format("no animation \"{}\": {} has none", wanted, file.name)));
    const std::string near = nearest(wanted, names);
    names.resize(std::min<size_t>(names.size(), 20));
    throw Error(Exit::usage, printable(fmt::format("no animation \"{}\" in {}; have 0 to {}, by name \"{}\", all or none{}", wanted,
                                                   file.name, all.size() - 1, fmt::join(names, "\", \""),
                                                   near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near))));
}

} // namespace

std::array<double, 4> Animations::Sampler::value(size_t key, size_t part) const {
    const float* v = &values[(way == Way::cubic ? 3 * key + part : key) * width];
    return {double(v[0]), double(v[1]), double(v[2]), width == 4 ? double(v[3]) : 0};
}

// glTF 2.0.1, appendix C.5: Hermite's cubic; tangents are per second.
std::array<double, 4> Animations::Sampler::spline(size_t key, double seconds) const {
    const double length = double(times[key + 1]) - double(times[key]), t = (seconds - double(times[key])) / length;
    const double t2 = t * t, t3 = t2 * t;
    const auto ends = mix(value(key), 2 * t3 - 3 * t2 + 1, value(key + 1), 3 * t2 - 2 * t3);
    const auto slopes = mix(value(key, 2), length * (t3 - 2 * t2 + t), value(key + 1, 0), length * (t3 - t2));
    const auto r = mix(ends, 1, slopes, 1);
    return width == 4 && !(normOf(r) > 1e-6) ? value(key) : r;
}

std::array<double, 4> Animations::Sampler::at(double seconds) const {
    if (!(seconds > double(times.front()))) return value(0);
    if (seconds >= double(times.back())) return value(times.size() - 1);
    const auto after = std::upper_bound(times.begin(), times.end(), seconds, [](double s, float t) { return s < double(t); });
    const size_t key = size_t(after - times.begin()) - 1;
    if (way == Way::step) return value(key);
    if (way == Way::cubic) return spline(key, seconds);
    const double f = (seconds - double(times[key])) / (double(times[key + 1]) - double(times[key]));
    return width == 4 ? slerp(value(key), value(key + 1), f) : mix(value(key), 1 - f, value(key + 1), f);
}

Animations::Sampler Animations::readSampler(const GltfFile& file, const std::string& place, const json& from, bool rotation) {
    const size_t input = from["input"], output = from["output"];
    const Accessor &times = file.accessors[input], &values = file.accessors[output];
    const std::string interpolation = from.value("interpolation", std::string("LINEAR"));
    Sampler s;
    if (interpolation != "LINEAR" && interpolation != "STEP" && interpolation != "CUBICSPLINE")
        file.fail(place + "/interpolation",
                  fmt::format("{} is none of LINEAR, STEP, CUBICSPLINE. Export the file again.", shown(interpolation)));
    s.way = interpolation == "STEP" ? Way::step : interpolation == "LINEAR" ? Way::linear : Way::cubic;
    s.width = rotation ? 4 : 3;
    if (times.type != "SCALAR" || times.component != 5126)
        file.fail(place + "/input", "must be SCALAR of floats: times in seconds. Export the file again.");
    if (values.type != (rotation ? "VEC4" : "VEC3"))
        file.fail(place + "/output",
                  fmt::format("has type {}, must be {}. Export the file again.", values.type, rotation ? "VEC4" : "VEC3"));
    const size_t wanted = times.count * (s.way == Way::cubic ? 3 : 1);
    if (values.count != wanted)
        file.fail(place + "/output",
                  fmt::format("has {} elements, its {} times need {}. Export the file again.", values.count, times.count, wanted));
    uint64_t bytes = 0;
    for (const Bytes& buffer : file.buffers) bytes += buffer.size();
    numbers_ += times.count + values.count * s.width;
    if (numbers_ > freeNumbers + bytes)
        file.fail(place, fmt::format("brings the animations to {} numbers, more than {} bytes of buffers can mean. Export the file again.",
                                     numbers_, bytes));
    s.times = readFloats(file, input);
    s.values = readFloats(file, output);
    for (size_t i = 0; i < s.times.size(); ++i)
        if (!std::isfinite(s.times[i]) || (i > 0 && s.times[i] < s.times[i - 1]))
            file.fail(place + "/input",
                      fmt::format("time {} is {}, must be a number not before the last. Export the file again.", i, s.times[i]));
    for (size_t i = 0; i < s.values.size(); ++i)
        if (!(std::abs(s.values[i]) <= 1e18f))
            file.fail(place + "/output", fmt::format("number {} is {}. Mend the animation and export it again.", i, s.values[i]));
    for (size_t key = 0; rotation && key < s.times.size(); ++key)
        if (!(normOf(s.value(key)) > 1e-6))
            file.fail(place + "/output", fmt::format("element {} is no quaternion. Export the file again.", key));
    return s;
}

void Animations::connect(const GltfFile& file, const std::string& place, const json& channel, std::vector<int>& read, size_t animation) {
    const json& target = channel["target"];
    const std::string path = target["path"];
    if (path == "weights") return file.warn("animates the weights of morph targets, which are not applied.");
    if (path == "pointer") return; // KHR_animation_pointer: the extension is named with those that are not applied
    const auto which = std::find(paths.begin(), paths.end(), path);
    if (which == paths.end()) return file.warn(fmt::format("animates {}, which is not applied.", shown(path)));
    if (!target.contains("node")) return file.warn("has animation channels without a target; they are not applied.");
    const size_t node = target["node"];
    if (!file.model.nodes[node].matrix.empty())
        return file.warn(fmt::format("/nodes/{} has a matrix; its animation is not applied.", node));
    const json& samplers = file.json["animations"][animation]["samplers"];
    const size_t sampler = channel["sampler"].get<size_t>();
    if (sampler >= samplers.size())
        file.fail(place + "/sampler",
                  fmt::format("is {}, but the animation has {} samplers. Export the file again.", sampler, samplers.size()));
    int& mine = channels_[node][size_t(which - paths.begin())];
    if (mine >= 0) {
        twice_ = true;
        return;
    }
    const bool rotation = path == "rotation";
    if (read[sampler] >= 0 && (samplers_[size_t(read[sampler])].width == 4) == rotation) {
        mine = read[sampler];
        return;
    }
    samplers_.push_back(readSampler(file, fmt::format("/animations/{}/samplers/{}", animation, sampler), samplers[sampler], rotation));
    mine = read[sampler] = int(samplers_.size()) - 1;
    info_[animation].seconds = std::max(info_[animation].seconds, double(samplers_.back().times.back()));
}

void Animations::play(const GltfFile& file, size_t animation) {
    const json& from = file.json["animations"][animation];
    info_[animation].used = true;
    info_[animation].seconds = 0;
    std::vector<int> read(from["samplers"].size(), -1);
    for (size_t i = 0; i < from["channels"].size(); ++i)
        connect(file, fmt::format("/animations/{}/channels/{}", animation, i), from["channels"][i], read, animation);
}

// What the file says of each, unread: a duration is the latest of the maxima that its inputs declare.
void Animations::describe(const GltfFile& file, const std::string& wanted) {
    for (const json& from : list(file, "animations")) {
        AnimationInfo info;
        info.name = from.value("name", std::string());
        for (const json& channel : from["channels"]) ++info.channels[channel["target"]["path"].get<std::string>()];
        for (const json& sampler : from["samplers"]) {
            const json& accessor = file.json["accessors"][sampler["input"].get<size_t>()];
            const json most = accessor.value("max", json::array());
            if (most.is_array() && most.size() == 1 && most[0].is_number()) info.seconds = std::max(info.seconds, most[0].get<double>());
        }
        info_.push_back(std::move(info));
    }
    for (const size_t animation : chosen(file, wanted)) play(file, animation);
}

Animations::Animations(const GltfFile& file, const std::string& wanted) {
    channels_.assign(list(file, "nodes").size(), still);
    describe(file, wanted);
    if (samplers_.empty()) channels_.clear();
    if (twice_) file.warn("animates the same property of a node twice; the first channel counts.");
}

void Animations::apply(size_t node, double seconds, Trs& trs) const {
    if (!moves(node)) return;
    const auto [translation, rotation, scale] = channels_[node];
    const auto three = [](const std::array<double, 4>& v) { return std::array<double, 3>{v[0], v[1], v[2]}; };
    if (translation >= 0) trs.translation = three(samplers_[size_t(translation)].at(seconds));
    if (rotation >= 0) trs.rotation = samplers_[size_t(rotation)].at(seconds);
    if (scale >= 0) trs.scale = three(samplers_[size_t(scale)].at(seconds));
}

} // namespace chiaro::gltf
