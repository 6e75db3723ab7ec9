// Cost of a tick on a robot of 32 drives of nine families, and on each family by itself: see
// docs/performance.md. The drives are the simulated ones: every frame is a real one.
//   mixed_bench CONFIG [TICKS]
#include <sys/socket.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/subnormals.hpp"
#include "bus/can_receiver.hpp"
#include "config/load_config.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/tick/scheduler.hpp"

namespace rc10::bench {
namespace {

[[nodiscard]] std::int64_t cpuNs() noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

[[noreturn]] void die(const std::string& why) {
  std::fprintf(stderr, "mixed_bench: %s\n", why.c_str());
  std::exit(1);
}

/// A whole robot with its simulated drives, in virtual time. The CPU time of the ticks is what is counted,
/// without the simulation.
class MixedRobot {
 public:
  explicit MixedRobot(const RobotConfig& config) : period_(config.period()) {
    auto built = Robot::build(config);
    if (!built) die(built.error().message);
    robot_ = std::move(*built);
    for (auto& port : robot_->simPorts()) wires_.emplace_back(port->descriptor());
    scheduler_ = std::make_unique<Scheduler>(*robot_, inboxes_, exchange_, period_);
    command_.client = "bench";
    command_.count = robot_->motors().size();
    for (std::size_t i = 0; i < command_.count; ++i) {
      command_.setpoints[i] = {static_cast<std::uint16_t>(i),
                               Target{.mode = ControlMode::kVelocity, .value = 60.0}};
    }
  }

  /// A millisecond. Returns what the tick took.
  std::int64_t tick() {
    now_ += period_;
    for (std::size_t bus = 0; bus < wires_.size(); ++bus) {
      const auto count = robot_->simPorts()[bus]->bus().step(now_, period_, feedback_);
      for (std::size_t i = 0; i < count; ++i) feedback_[i].received = now_ - period_ / 2;
      inboxes_[bus].frames.push(feedback_.data(), count);
      received_ += count;
    }
    const auto before = cpuNs();
    scheduler_->tick(now_);
    const auto took = cpuNs() - before;
    const WakeUp wake{.now = now_, .previous = now_, .realtime_offset = {}, .previous_offset = {}};
    for (std::size_t bus = 0; bus < wires_.size(); ++bus) {
      const auto count = wires_[bus].receive(wake, batch_).frame_count;
      for (std::size_t i = 0; i < count; ++i) robot_->simPorts()[bus]->bus().receive(batch_[i]);
      sent_ += count;
    }
    OrderResult result;
    while (exchange_.results.pop(result)) {
    }
    Event event;
    while (exchange_.events.pop(event)) {
    }
    return took;
  }

  /// Enables all and lets them turn.
  void start() {
    for (int attempt = 0; attempt < 10 && !allActive(); ++attempt) {
      for (int i = 0; i < 1000; ++i) tick();
      Order order;
      order.id = static_cast<std::uint64_t>(attempt) + 1;
      order.operation = Operation::kEnable;
      for (std::size_t i = 0; i < robot_->motors().size(); ++i) order.motors.set(i);
      exchange_.orders.push(order);
      for (int i = 0; i < 3000; ++i) tick();
    }
    if (!allActive()) die("not every motor is ACTIVE");
    command_.received = command_.said = now_;
    command_.deadline = now_ + std::chrono::hours{24};
    exchange_.commands.push(command_);
    for (int i = 0; i < 2000; ++i) tick();
    received_ = sent_ = 0;
  }
  [[nodiscard]] bool allActive() {
    const auto& snapshot = exchange_.snapshot.read();
    for (std::size_t i = 0; i < robot_->motors().size(); ++i) {
      if (snapshot.motors[i].status != MotorStatus::kActive) return false;
    }
    return snapshot.motor_count > 0;
  }
  [[nodiscard]] std::size_t motors() const { return robot_->motors().size(); }
  [[nodiscard]] std::uint64_t received() const { return received_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  Duration period_;
  MonotonicTime now_{std::chrono::seconds{1000}};
  std::unique_ptr<Robot> robot_;
  std::array<BusInbox, kMaxBuses> inboxes_;
  LinkExchange exchange_;
  std::unique_ptr<Scheduler> scheduler_;
  std::vector<CanReceiver> wires_;
  std::array<CanFrame, CanReceiver::kBatch> batch_{};
  std::array<CanFrame, 256> feedback_{};
  Command command_;
  std::uint64_t received_ = 0;
  std::uint64_t sent_ = 0;
};

void measure(const std::string& name, const RobotConfig& config, int ticks) {
  MixedRobot robot(config);
  robot.start();
  std::vector<std::int64_t> times(static_cast<std::size_t>(ticks));
  for (auto& each : times) each = robot.tick();
  if (!robot.allActive()) die(name + ": a motor is no longer ACTIVE");
  std::sort(times.begin(), times.end());
  const auto at = [&times](double share) {
    return static_cast<double>(
               times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))]) /
           1000.0;
  };
  std::printf("| %s | %zu | %.1f | %.1f | %.2f | %.2f | %.2f | %.0f |\n", name.c_str(), robot.motors(),
              static_cast<double>(robot.received()) / ticks, static_cast<double>(robot.sent()) / ticks,
              at(0.5), at(0.99), at(0.999), at(0.5) * 1000.0 / static_cast<double>(robot.motors()));
}

/// The same robot with the motors of one family only.
RobotConfig only(const RobotConfig& config, const MotorFamily* family) {
  RobotConfig out = config;
  for (auto& bus : out.buses) {
    std::erase_if(bus.motors, [family](const MotorConfig& motor) { return motor.family != family; });
  }
  std::erase_if(out.buses, [](const BusConfig& bus) { return bus.motors.empty(); });
  return out;
}

}  // namespace
}  // namespace rc10::bench

int main(int argc, char** argv) {
  using namespace rc10::bench;
  rc10::flushSubnormals();  // as the scheduler's thread
  if (argc < 2) die("mixed_bench CONFIG [TICKS]");
  const int ticks = argc > 2 ? std::max(std::atoi(argv[2]), 1) : 60'000;
  const auto outcome = rc10::loadRobotConfig(argv[1]);
  if (!outcome.config) die(outcome.errorText());
  const auto& config = *outcome.config;
  std::puts(
      "| robot | motors | frames in | out | median us | p99 us | p99.9 us | ns per motor "
      "|\n|---|---|---|---|---|---|---|---|");
  measure("all", config, ticks);
  std::map<std::string, const rc10::MotorFamily*> families;
  for (const auto& bus : config.buses) {
    for (const auto& motor : bus.motors) families[std::string(motor.family->name())] = motor.family;
  }
  for (const auto& [name, family] : families) measure(name, only(config, family), ticks);
}
