#include "io/gltf_animation.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

constexpr std::array<const char*, 4> paths = {"translation", "rotation", "scale", "weights"};
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

double Animations::Sampler::number(size_t key, size_t component, size_t part) const {
    return double(values[(way == Way::cubic ? 3 * key + part : key) * width + component]);
}

std::array<double, 4> Animations::Sampler::value(size_t key, size_t part) const {
    std::array<double, 4> v{};
    for (size_t i = 0; i < width; ++i) v[i] = number(key, i, part);
    return v;
}

Animations::Sampler::Place Animations::Sampler::place(double seconds) const {
    if (!(seconds > double(times.front()))) return {0, 0};
    if (seconds >= double(times.back())) return {times.size() - 1, 0};
    const auto after = std::upper_bound(times.begin(), times.end(), seconds, [](double s, float t) { return s < double(t); });
    const size_t key = size_t(after - times.begin()) - 1;
    return {key, way == Way::step ? 0 : (seconds - double(times[key])) / length(key)};
}

// glTF 2.0.1, appendix C.5: Hermite's cubic; tangents are per second.
double Animations::Sampler::number(const Place& p, size_t component) const {
    const double t = p.share, t2 = t * t, t3 = t2 * t;
    if (t == 0) return number(p.key, component);
    if (way == Way::linear) return number(p.key, component) * (1 - t) + number(p.key + 1, component) * t;
    return number(p.key, component) * (2 * t3 - 3 * t2 + 1) + number(p.key + 1, component) * (3 * t2 - 2 * t3) +
           length(p.key) * (number(p.key, component, 2) * (t3 - 2 * t2 + t) + number(p.key + 1, component, 0) * (t3 - t2));
}

std::array<double, 4> Animations::Sampler::at(double seconds) const {
    const Place p = place(seconds);
    if (p.share == 0) return value(p.key);
    if (width == 4 && way == Way::linear) return slerp(value(p.key), value(p.key + 1), p.share);
    std::array<double, 4> r{};
    for (size_t i = 0; i < width; ++i) r[i] = number(p, i);
    return width == 4 && !(normOf(r) > 1e-6) ? value(p.key) : r;
}

Animations::Sampler Animations::readSampler(const GltfFile& file, const std::string& place, const json& from, Property property,
                                            size_t width) {
    const size_t input = from["input"], output = from["output"];
    const Accessor &times = file.accessors[input], &values = file.accessors[output];
    const std::string interpolation = from.value("interpolation", std::string("LINEAR"));
    Sampler s;
    if (interpolation != "LINEAR" && interpolation != "STEP" && interpolation != "CUBICSPLINE")
        file.fail(place + "/interpolation",
                  fmt::format("{} is none of LINEAR, STEP, CUBICSPLINE. Export the file again.", shown(interpolation)));
    s.way = interpolation == "STEP" ? Way::step : interpolation == "LINEAR" ? Way::linear : Way::cubic;
    s.width = width;
    const bool morphs = property == weights;
    if (times.type != "SCALAR" || times.component != 5126)
        file.fail(place + "/input", "must be SCALAR of floats: times in seconds. Export the file again.");
    const char* const type = morphs ? "SCALAR" : property == rotation ? "VEC4" : "VEC3";
    if (values.type != type)
        file.fail(place + "/output", fmt::format("has type {}, must be {}. Export the file again.", values.type, type));
    const uint64_t wanted = uint64_t(times.count) * (s.way == Way::cubic ? 3 : 1) * (morphs ? width : 1);
    if (values.count != wanted)
        file.fail(place + "/output", fmt::format("has {} elements, its {} times{} need {}. Export the file again.", values.count,
                                                 times.count, morphs ? fmt::format(" of {} morph targets", width) : "", wanted));
    uint64_t bytes = 0;
    for (const Bytes& buffer : file.buffers) bytes += buffer.size();
    numbers_ += times.count + values.count * (morphs ? 1 : width);
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
    for (size_t key = 0; property == rotation && key < s.times.size(); ++key)
        if (!(normOf(s.value(key)) > 1e-6))
            file.fail(place + "/output", fmt::format("element {} is no quaternion. Export the file again.", key));
    return s;
}

void Animations::connect(const GltfFile& file, const std::string& place, const json& channel, ReadSamplers& read, size_t animation) {
    const json& target = channel["target"];
    const std::string path = target["path"];
    if (path == "pointer") return; // KHR_animation_pointer: the extension is named with those that are not applied
    const auto which = std::find(paths.begin(), paths.end(), path);
    if (which == paths.end()) return file.warn(fmt::format("animates {}, which is not applied.", shown(path)));
    if (!target.contains("node")) return file.warn("has animation channels without a target; they are not applied.");
    const size_t node = target["node"];
    const auto property = Property(which - paths.begin());
    const size_t width = property == weights ? targetsOf(file, file.model.nodes[node].mesh) : property == rotation ? 4 : 3;
    if (width == 0) return file.warn(fmt::format("animates morph targets of /nodes/{}, which has none.", node));
    if (property != weights && !file.model.nodes[node].matrix.empty())
        return file.warn(fmt::format("/nodes/{} has a matrix; its animation is not applied.", node));
    const json& samplers = file.json["animations"][animation]["samplers"];
    const size_t sampler = channel["sampler"].get<size_t>();
    if (sampler >= samplers.size())
        file.fail(place + "/sampler",
                  fmt::format("is {}, but the animation has {} samplers. Export the file again.", sampler, samplers.size()));
    int& mine = channels_[node][property];
    if (mine >= 0) {
        twice_ = true;
        return;
    }
    const auto [known, isNew] = read.try_emplace({sampler, property == weights, width}, int(samplers_.size()));
    mine = known->second;
    if (!isNew) return;
    samplers_.push_back(
        readSampler(file, fmt::format("/animations/{}/samplers/{}", animation, sampler), samplers[sampler], property, width));
    info_[animation].seconds = std::max(info_[animation].seconds, double(samplers_.back().times.back()));
}

void Animations::play(const GltfFile& file, size_t animation) {
    const json& from = file.json["animations"][animation];
    info_[animation].used = true;
    info_[animation].seconds = 0;
    ReadSamplers read;
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
    const auto at = [&](Property property) { return samplers_[size_t(channels_[node][property])].at(seconds); };
    const auto three = [](const std::array<double, 4>& v) { return std::array<double, 3>{v[0], v[1], v[2]}; };
    if (channels_[node][translation] >= 0) trs.translation = three(at(translation));
    if (channels_[node][rotation] >= 0) trs.rotation = at(rotation);
    if (channels_[node][scale] >= 0) trs.scale = three(at(scale));
}

void Animations::apply(size_t node, double seconds, std::vector<double>& all) const {
    if (!morphs(node)) return;
    const Sampler& s = samplers_[size_t(channels_[node][weights])];
    const Sampler::Place place = s.place(seconds);
    for (size_t i = 0; i < std::min(all.size(), s.width); ++i) all[i] = s.number(place, i);
}

} // namespace chiaro::gltf
