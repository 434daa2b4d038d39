#include "tools/cli/signals.h"
#include "core/render/error.h"
#include <array>
#include <atomic>
#include <csignal>
#include <unistd.h>

namespace chiaro::cli {
namespace {

std::atomic<StopToken*> token{nullptr};
static_assert(std::atomic<StopToken*>::is_always_lock_free, "used in a signal handler");
constexpr std::array<int, 2> signals = {SIGINT, SIGTERM};
std::array<struct sigaction, 2> before;

extern "C" void onSignal(int) {
    StopToken* stop = token.load();
    if (!stop || stop->cancelled()) _exit(int(Exit::killed));
    stop->request();
}

} // namespace

StopOnSignal::StopOnSignal(StopToken& stop) {
    token.store(&stop);
    struct sigaction action {};
    action.sa_handler = onSignal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < signals.size(); ++i) {
        sigaction(signals[i], nullptr, &before[i]);
        if (before[i].sa_handler != SIG_IGN) sigaction(signals[i], &action, nullptr); // nohup and background jobs keep their peace
    }
}

StopOnSignal::~StopOnSignal() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before[i], nullptr);
    token.store(nullptr);
}

} // namespace chiaro::cli
