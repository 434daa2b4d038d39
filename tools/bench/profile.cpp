#include "tools/bench/profile.h"
#include "tools/bench/measure.h"
#include "tools/bench/symbols.h"
#include <algorithm>
#include <atomic>
#include <csignal>
#include <sys/resource.h>
#include <sys/time.h>
#include <ucontext.h>
#include <unordered_map>
#include <vector>

namespace chiaro::bench {
namespace {

constexpr std::size_t mostSamples = 1 << 18;
constexpr long microsecondsApart = 1000; // the kernel may make it more

std::atomic<std::size_t> taken{0};
uintptr_t* addresses = nullptr; // written by the handler alone

void take(int, siginfo_t*, void* context) {
#if defined(__x86_64__)
    const std::size_t i = taken.fetch_add(1, std::memory_order_relaxed);
    if (i < mostSamples) addresses[i] = uintptr_t(static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
#else
    (void)context;
#endif
}

double processorSeconds() {
    struct rusage u {};
    getrusage(RUSAGE_SELF, &u);
    return double(u.ru_utime.tv_sec) + double(u.ru_stime.tv_sec) + 1e-6 * double(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

void ask(long microseconds) {
    const itimerval every{{0, microseconds}, {0, microseconds}};
    setitimer(ITIMER_PROF, &every, nullptr);
}

bool has(std::string_view name, std::initializer_list<std::string_view> words) {
    return std::any_of(words.begin(), words.end(), [&](std::string_view w) { return name.find(w) != name.npos; });
}

Part partOfLibrary(std::string_view file) {
    if (has(file, {"embree"})) return Part::trace;
    if (has(file, {"libm.", "libm-"})) return Part::shading;
    if (has(file, {"tbb"})) return Part::waiting; // its threads look for work
    return Part::other;
}

} // namespace

std::string_view partName(Part p) noexcept {
    static constexpr std::array<std::string_view, partCount> names = {"trace",   "packets", "lights", "shading", "textures",
                                                                      "sampler", "film",    "walk",   "other",   "waiting"};
    return names[std::size_t(p)];
}

Part partOf(std::string_view f) noexcept {
    if (has(f, {"Film", "toFixed", "Outputs::"})) return Part::film;
    if (has(f, {"Textures", "texture", "Scene::sample"})) return Part::textures;
    if (has(f, {"Accel", "RayPacket", "Scene::intersect", "Scene::occluded", "filterCutOut", "fillLanes", "fillAvx", "fillBaseline"}))
        return Part::packets;
    if (has(f, {"Lights", "lights", "Light", "light", "Distribution", "Environment", "descend"})) return Part::lights;
    if (has(f, {"Sampler", "sobol", "Sobol", "shuffled"})) return Part::sampler;
    if (has(f, {"Bsdf", "shade", "Shade", "Lobe", "lobe", "microfacet", "resnel", "Scene::point", "Scene::flat", "Scene::attributes",
                "urface", "Frame::", "warp"}))
        return Part::shading;
    return has(f, {"chiaro::"}) ? Part::walk : Part::other;
}

struct Profile::Impl {
    std::vector<uintptr_t> room = std::vector<uintptr_t>(mostSamples);
    struct sigaction before {};
    Clock::time_point began;
    double worked = 0, seconds = 0;
};

Profile::Profile() : impl_(std::make_unique<Impl>()) {
    addresses = impl_->room.data();
    taken = 0;
    struct sigaction how {};
    how.sa_sigaction = take;
    how.sa_flags = SA_SIGINFO | SA_RESTART;
    sigemptyset(&how.sa_mask);
    sigaction(SIGPROF, &how, &impl_->before);
}
Profile::~Profile() {
    ask(0);
    struct sigaction ignore {}; // one may be on its way
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPROF, &ignore, nullptr);
    addresses = nullptr;
}

void Profile::start() {
    impl_->began = Clock::now();
    impl_->worked -= processorSeconds();
    ask(microsecondsApart);
}
void Profile::stop() {
    ask(0);
    impl_->worked += processorSeconds();
    impl_->seconds += secondsSince(impl_->began);
}

TimeSplit Profile::split(unsigned threads) const {
    TimeSplit s;
    s.samples = std::min(taken.load(), mostSamples);
    if (s.samples == 0) return s;
    s.idle = std::max(0.0, 1 - impl_->worked / (threads * impl_->seconds));
    const double each = 1 / double(s.samples);
    const Symbols symbols;
    std::unordered_map<uintptr_t, uint64_t> counts;
    for (uint64_t i = 0; i < s.samples; ++i) ++counts[impl_->room[i]];
    for (const auto& [address, count] : counts) {
        const Symbols::Place place = symbols.at(address);
        const Part part = place.library ? partOfLibrary(place.name) : partOf(place.name);
        s.share[std::size_t(part)] += each * double(count);
        s.functions[place.name] += each * double(count);
    }
    return s;
}

} // namespace chiaro::bench
