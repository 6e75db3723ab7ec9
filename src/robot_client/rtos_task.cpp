#include "rc10/rtos_task.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <future>
#include <memory>

#include "robot_client/session/host_clock.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

void sleepUntil(MonotonicTime due) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  const std::int64_t ns = due.time_since_epoch().count();
  const timespec until{.tv_sec = ns / kNsPerSecond, .tv_nsec = ns % kNsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

[[nodiscard]] std::string applyPolicy(const TaskOptions& options) {
  if (options.policy == SchedPolicy::kOther) return {};
  const int policy = options.policy == SchedPolicy::kFifo ? SCHED_FIFO : SCHED_RR;
  sched_param param{};
  param.sched_priority = options.priority;
  const int error = pthread_setschedparam(pthread_self(), policy, &param);
  if (error == 0) return {};
  const std::string asked =
      (policy == SCHED_FIFO ? "SCHED_FIFO " : "SCHED_RR ") + std::to_string(options.priority);
  if (error == EINVAL) return asked + " was refused: a priority is within 1 to 99";
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  return asked + " was refused (" + std::strerror(error) + "; RLIMIT_RTPRIO is " +
         std::to_string(limit.rlim_cur) +
         "): run under systemd with LimitRTPRIO=" + std::to_string(options.priority) +
         ", or add `YOUR_NAME - rtprio " + std::to_string(options.priority) +
         "` to a file in /etc/security/limits.d/";
}

[[nodiscard]] std::string applyCpu(const TaskOptions& options) {
  if (!options.cpu) return {};
  const long cpus = sysconf(_SC_NPROCESSORS_CONF);
  cpu_set_t set;
  CPU_ZERO(&set);
  if (*options.cpu >= 0 && *options.cpu < std::min<long>(cpus, CPU_SETSIZE)) {
    CPU_SET(static_cast<std::size_t>(*options.cpu), &set);
    if (pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0) return {};
  }
  return "CPU " + std::to_string(*options.cpu) + " was refused: this machine has CPUs 0 to " +
         std::to_string(cpus - 1) + ", and the task may be kept off some";
}

/// Settings of the calling thread.
[[nodiscard]] std::string apply(const TaskOptions& options) {
  pthread_setname_np(pthread_self(), options.name.substr(0, 15).c_str());
  std::string problem = applyCpu(options);
  if (const auto policy = applyPolicy(options); !policy.empty()) {
    problem += (problem.empty() ? "" : "; ") + policy;
  }
  return problem.empty() ? problem : "task " + options.name + ": " + problem;
}

}  // namespace

Rate::Next Rate::next(MonotonicTime due, Duration period, MonotonicTime now) noexcept {
  due += period;
  if (due >= now) return {due, 0};
  const auto missed = (now - due) / period + ((now - due) % period != Duration::zero() ? 1 : 0);
  return {due + missed * period, static_cast<std::uint64_t>(missed)};
}

Rate::Rate(Duration period) : period_(std::max(period, Duration{1})), due_(timeNow()) {}

std::uint64_t Rate::wait() {
  const auto [due, missed] = next(due_, period_, timeNow());
  due_ = due;
  sleepUntil(due);
  return missed;
}

struct RtosTask::Start {
  RtosTask* task;
  std::function<void(std::stop_token)> body;
  std::promise<std::string> set_up;
  std::promise<bool> go;
};

void* RtosTask::entry(void* start) {
  const std::unique_ptr<std::shared_ptr<Start>> handed(static_cast<std::shared_ptr<Start>*>(start));
  Start& own = **handed;
  const auto stop = own.task->stop_.get_token();
  own.set_up.set_value(apply(own.task->options_));
  if (own.go.get_future().get()) own.body(stop);
  own.task->running_.store(false);
  return nullptr;
}

Result<void> RtosTask::launch(std::function<void(std::stop_token)> body) {
  if (joinable_) return fail("task " + options_.name + " runs already: stop it first");
  stop_ = std::stop_source{};
  cycles_.store(0);
  overruns_.store(0);
  // State of both threads: neither knows which is the last to let go of the promises.
  const auto start = std::make_shared<Start>(Start{this, std::move(body), {}, {}});
  auto set_up = start->set_up.get_future();
  auto handed = std::make_unique<std::shared_ptr<Start>>(start);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  // Not the creator's policy: each task sets its own.
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  if (options_.stack_bytes != 0) {
    pthread_attr_setstacksize(&attributes,
                              std::max<std::size_t>(options_.stack_bytes, std::size_t{64} * 1024));
  }
  running_.store(true);
  const int error = pthread_create(&thread_, &attributes, &RtosTask::entry, handed.get());
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    running_.store(false);
    return fail("task " + options_.name + " could not be started: " + std::strerror(error));
  }
  (void)handed.release();  // now the thread's
  joinable_ = true;
  problem_ = set_up.get();
  const bool good = problem_.empty() || !options_.required;
  start->go.set_value(good);
  if (good) return {};
  stop();
  return fail(problem_);
}

Result<void> RtosTask::start(std::optional<Duration> period) {
  if (period) return startLoop(*period, [this] { loop(); });
  return startRun([this](std::stop_token stop) { run(std::move(stop)); });
}

Result<void> RtosTask::startLoop(Duration period, std::function<void()> loop) {
  if (period <= Duration::zero()) return fail("task " + options_.name + ": a period is above 0");
  return launch(
      [this, period, loop = std::move(loop)](const std::stop_token& stop) { repeat(period, loop, stop); });
}

Result<void> RtosTask::startRun(std::function<void(std::stop_token)> run) { return launch(std::move(run)); }

void RtosTask::repeat(Duration period, const std::function<void()>& loop, const std::stop_token& stop) {
  Rate rate(period);
  while (!stop.stop_requested()) {
    overruns_.fetch_add(rate.wait());
    if (stop.stop_requested()) return;
    loop();
    cycles_.fetch_add(1);
  }
}

void RtosTask::stop() noexcept {
  if (!joinable_) return;
  stop_.request_stop();
  pthread_join(thread_, nullptr);
  joinable_ = false;
}

}  // namespace robot_client
}  // namespace rc10
