// Cost of one tick of each type of module: its inputs, its update(), and what it asks of the motors. See
// docs/performance.md.
//   module_bench [Google Benchmark's options]
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "app/subnormals.hpp"
#include "bus/can_receiver.hpp"
#include "config/load_config.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/supervision/supervisor.hpp"
#include "daemon/tick/module_runner.hpp"
#include "support/module_cases.hpp"

namespace rc10::bench {
namespace {

constexpr Duration kPeriod{std::chrono::milliseconds{1}};

[[noreturn]] void die(const std::string& why) {
  std::fprintf(stderr, "module_bench: %s\n", why.c_str());
  std::exit(1);
}

[[nodiscard]] std::unique_ptr<Robot> build(const test::ModuleCase& module) {
  auto loaded = parseRobotConfig(module.yaml(), module.type);
  if (!loaded.config) die(loaded.errorText());
  auto robot = Robot::build(*loaded.config);
  if (!robot) die(robot.error().message);
  return std::move(*robot);
}

/// A robot with one module that has its inputs, and whose motors are ACTIVE. Then time stands still.
class ModuleRig {
 public:
  explicit ModuleRig(const test::ModuleCase& module)
      : robot_(build(module)), supervisor_(*robot_, link_), runner_(*robot_, supervisor_, link_) {
    for (auto& entry : robot_->buses()) receivers_.emplace_back(entry.bus->descriptor());
    chunk_.size = static_cast<std::uint16_t>(module.frame.size());
    std::copy(module.frame.begin(), module.frame.end(), chunk_.data.begin());
    run(10);
    Order enable{1, Operation::kEnable, {}, 0.0};
    for (std::size_t i = 0; i < robot_->motors().size(); ++i) enable.motors.set(i);
    link_.orders.push(enable);
    if (!module.inputs.empty()) give(module);
    run(100);
    for (std::size_t i = 0; i < static_cast<std::size_t>(module.motors); ++i) {
      if (supervisor_.status(i) != MotorStatus::kActive) die(module.type + ": its motors are not ACTIVE");
    }
  }

  /// The subject.
  void update() noexcept { runner_.update(tick()); }

  [[nodiscard]] bool hasDevice() const noexcept { return chunk_.size > 0; }
  /// A frame of its serial device comes and is decoded.
  void hear() noexcept {
    chunk_.received += std::chrono::milliseconds{14};
    robot_->serialDevices()[0].device->receive(chunk_);
  }

 private:
  [[nodiscard]] Tick tick() const noexcept { return {ticks_, now_, seconds(kPeriod)}; }

  void give(const test::ModuleCase& module) {
    SignalMessage message;
    message.client = "bench";
    message.session = 1;
    message.received = now_ + kPeriod;  // the tick in which its motors are enabled
    message.deadline = now_ + std::chrono::hours{24};
    message.values.fill(kNoSignal);
    const auto& names = robot_->modules()[0].module->signals().inputs;
    for (const auto& [name, value] : module.inputs) {
      const auto input = std::find(names.begin(), names.end(), name);
      if (input == names.end()) die(module.type + " has no input " + name);
      message.values[static_cast<std::size_t>(input - names.begin())] = value;
    }
    link_.signals.push(message);
  }

  // As Scheduler::tick(), without what watches the buses.
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      ++ticks_;
      now_ += kPeriod;
      for (auto& port : robot_->simPorts()) port->step(now_ - kPeriod / 2);
      const WakeUp wake{.now = now_, .previous = now_, .realtime_offset = {}, .previous_offset = {}};
      for (std::size_t bus = 0; bus < receivers_.size(); ++bus) {
        const auto count = receivers_[bus].receive(wake, batch_).frame_count;
        for (std::size_t frame = 0; frame < count; ++frame) robot_->buses()[bus].bus->dispatch(batch_[frame]);
      }
      if (hasDevice() && ticks_ % 14 == 0) {
        chunk_.received = now_;
        robot_->serialDevices()[0].device->receive(chunk_);
      }
      supervisor_.receiveOrders(tick());
      runner_.update(tick());
      supervisor_.decide(tick());
      for (auto& entry : robot_->motors()) entry.motor->update(tick());
      for (auto& entry : robot_->buses()) entry.bus->packCommands(tick());
      for (auto& entry : robot_->buses()) entry.bus->flush();
      OrderResult result;
      while (link_.results.pop(result)) {
      }
    }
  }

  std::unique_ptr<Robot> robot_;
  LinkExchange link_;
  Supervisor supervisor_;
  ModuleRunner runner_;
  std::vector<CanReceiver> receivers_;
  std::array<CanFrame, CanReceiver::kBatch> batch_{};
  SerialChunk chunk_;
  std::uint64_t ticks_ = 0;
  MonotonicTime now_{std::chrono::hours{1}};
};

void add(const test::ModuleCase& module) {
  benchmark::RegisterBenchmark((module.type + "/tick").c_str(), [module](benchmark::State& state) {
    ModuleRig rig(module);
    for (auto _ : state) rig.update();
  });
  if (module.frame.empty()) return;
  benchmark::RegisterBenchmark((module.type + "/frame").c_str(), [module](benchmark::State& state) {
    ModuleRig rig(module);
    for (auto _ : state) rig.hear();
  });
}

}  // namespace
}  // namespace rc10::bench

int main(int argc, char** argv) {
  rc10::flushSubnormals();  // as the scheduler's thread
  for (const auto& module : rc10::test::moduleCases()) rc10::bench::add(module);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
