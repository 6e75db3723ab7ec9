#include "daemon/threads/rt_thread.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <future>
#include <memory>

#include <fmt/format.h>

#include "app/guard_priority.hpp"
#include "app/sanitizers.hpp"
#include "app/subnormals.hpp"

namespace rc10 {
namespace {

// Real-time stacks are small, locked, and touched before the first tick. The deepest use measured is 32 KiB,
// of the thread that copies recordings.
// A sanitizer keeps its own data of a thread on the thread's stack: over 100 KiB.
constexpr std::size_t kStackBytes = std::size_t{kSanitized ? 1024 : 128} * 1024;
constexpr std::size_t kPrefaultBytes = std::size_t{96} * 1024;

[[gnu::noinline]] void touchStack() noexcept {
  std::array<volatile char, kPrefaultBytes> room;
  for (std::size_t i = 0; i < room.size(); i += 1024) room[i] = 0;
}

[[nodiscard]] std::string rightsHint(int priority) {
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  const int enough = std::max(priority, kGuardPriority);  // of the guard as well
  return fmt::format(
      "RLIMIT_RTPRIO is {}: run under systemd with LimitRTPRIO={}, or add `YOUR_NAME - rtprio {}` to "
      "a file in /etc/security/limits.d/, or run as root{}",
      limit.rlim_cur, enough, enough,
      limit.rlim_cur >= static_cast<rlim_t>(priority)
          ? "; if root is refused too, the kernel has RT_GROUP_SCHED: `sysctl -w "
            "kernel.sched_rt_runtime_us=-1`"
          : "");
}

[[nodiscard]] Result<void> applyPolicy(const RtSettings& settings) {
  if (settings.priority == 0) return {};
  sched_param param{};
  param.sched_priority = settings.priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &param); error != 0) {
    return fail(fmt::format("thread {}: SCHED_FIFO {} was refused ({}). {}", settings.name, settings.priority,
                            std::strerror(error), rightsHint(settings.priority)));
  }
  int policy = 0;
  sched_param readback{};
  pthread_getschedparam(pthread_self(), &policy, &readback);
  if (policy != SCHED_FIFO || readback.sched_priority != settings.priority) {
    return fail(fmt::format("thread {}: asked for SCHED_FIFO {}, the kernel reports policy {} priority {}",
                            settings.name, settings.priority, policy, readback.sched_priority));
  }
  return {};
}

[[nodiscard]] Result<void> applyCpu(const RtSettings& settings) {
  if (!settings.cpu) return {};
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(*settings.cpu), &set);
  if (const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set); error != 0) {
    return fail(fmt::format("thread {}: CPU {} was refused ({}): this machine has CPUs 0 to {}",
                            settings.name, *settings.cpu, std::strerror(error),
                            sysconf(_SC_NPROCESSORS_ONLN) - 1));
  }
  cpu_set_t readback;
  pthread_getaffinity_np(pthread_self(), sizeof readback, &readback);
  if (CPU_EQUAL(&set, &readback) == 0) {
    return fail(
        fmt::format("thread {}: asked for CPU {}, the kernel allows others", settings.name, *settings.cpu));
  }
  return {};
}

}  // namespace

int realtimePercent() {
  long long runtime_us = -1;
  long long period_us = 0;
  std::ifstream("/proc/sys/kernel/sched_rt_runtime_us") >> runtime_us;
  std::ifstream("/proc/sys/kernel/sched_rt_period_us") >> period_us;
  if (runtime_us <= 0 || period_us <= 0) return 100;
  return static_cast<int>(std::clamp(100 * runtime_us / period_us, 1LL, 100LL));
}

Result<void> applyRtSettings(const RtSettings& settings) {
  pthread_setname_np(pthread_self(), settings.name.substr(0, 15).c_str());
  touchStack();
  flushSubnormals();
  if (auto done = applyCpu(settings); !done) return done;
  return applyPolicy(settings);
}

struct RtThread::Start {
  RtThread* thread;
  RtSettings settings;
  std::function<void(std::stop_token)> body;
  std::promise<Result<void>> set_up;
};

void* RtThread::entry(void* start) {
  const std::unique_ptr<Start> own(static_cast<Start*>(start));
  own->thread->tid_.store(gettid());
  const auto stop = own->thread->stop_.get_token();
  own->set_up.set_value(applyRtSettings(own->settings));
  own->body(stop);
  return nullptr;
}

Result<void> RtThread::start(RtSettings settings, std::function<void(std::stop_token)> body) {
  auto start = std::make_unique<Start>(Start{this, std::move(settings), std::move(body), {}});
  auto set_up = start->set_up.get_future();
  const std::string name = start->settings.name;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  // Not the creator's policy: each thread sets its own.
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  const int error = pthread_create(&thread_, &attributes, &RtThread::entry, start.get());
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    return fail(fmt::format(
        "thread {} could not be started ({}){}", name, std::strerror(error),
        error == EAGAIN ? ": RLIMIT_MEMLOCK is too small for its stack; set LimitMEMLOCK=infinity" : ""));
  }
  (void)start.release();  // now owned by the thread
  running_ = true;
  return set_up.get();
}

void RtThread::join() noexcept {
  if (!running_) return;
  stop_.request_stop();
  pthread_join(thread_, nullptr);
  running_ = false;
}

}  // namespace rc10
