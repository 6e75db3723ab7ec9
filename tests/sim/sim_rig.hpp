#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bus/can_receiver.hpp"
#include "bus/fdcan_bus.hpp"
#include "drives/dji/dji_group.hpp"
#include "drives/dji/dji_motor.hpp"
#include "drives/dji/dji_simulated.hpp"
#include "motor/geared_loops.hpp"
#include "sim/sim_port.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test {

struct SimRigConfig {
  std::vector<sim::DjiDriveConfig> drives;
  std::uint64_t seed = 1;

  [[nodiscard]] sim::SimBusConfig bus() const {
    sim::SimBusConfig config;
    config.seed = seed;
    for (const auto& drive : drives) config.drives.push_back(sim::djiDrive(drive));
    return config;
  }
};

/// One bus, its motors and their drives, over a real socket pair in virtual time: the tick at whole
/// milliseconds, the drives half a millisecond later.
class SimRig {
 public:
  explicit SimRig(const SimRigConfig& config) {
    auto ends = sim::SimPort::makeSocketPair();
    bus_ = fdCANbus::adopt("simulated", std::move(ends->first), false);
    port_ = std::make_unique<sim::SimPort>(std::move(ends->second), config.bus(), sim::Stamps::kOwn);
    receiver_ = std::make_unique<CanReceiver>(bus_->descriptor());
    for (const auto& drive : config.drives) add(drive);
    port_->step(now_ - kHalfPeriod);
  }

  [[nodiscard]] DJI_Motor& motor(std::size_t i) { return *motors_[i]; }
  [[nodiscard]] const sim::MotorPhysics& truth(std::size_t i) const { return port_->bus().motor(i); }
  [[nodiscard]] sim::SimPort& port() { return *port_; }
  [[nodiscard]] fdCANbus& bus() { return *bus_; }
  [[nodiscard]] MonotonicTime now() const { return now_; }

  void command(std::size_t i, const Target& target) {
    motors_[i]->order(FrameKind::kCommand);
    motors_[i]->setTarget(target);
  }

  /// `each_tick` is called when the motors' feedback of a millisecond has arrived.
  void run(Duration duration, const std::function<void()>& each_tick = {}) {
    for (const MonotonicTime end = now_ + duration; now_ < end; now_ += 2 * kHalfPeriod) {
      const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
      for (auto& motor : motors_) motor->update(tick);
      bus_->packCommands(tick);
      bus_->flush();
      port_->step(now_ + kHalfPeriod);
      receive(now_ + kHalfPeriod);
      if (each_tick) each_tick();
    }
  }

 private:
  static constexpr Duration kHalfPeriod{std::chrono::microseconds{500}};

  void add(const sim::DjiDriveConfig& drive) {
    MotorSettings config;
    config.name = drive.name;
    config.model = drive.model->name;
    config.id = drive.id;
    config.own = djiOwn(drive.command);
    config.gear_ratio = drive.gear_ratio;
    config.loops = loopsBehindGear(drive.model->command(drive.command).default_loops,
                                   gearRatioOf(config, *drive.model) / drive.model->gear_ratio);
    motors_.push_back(std::make_unique<DJI_Motor>(config));
    (void)bus_->registerMotor(*motors_.back());
    for (auto& group : groups_) {
      if (group->registerMotor(*motors_.back())) return;
    }
    groups_.push_back(std::make_unique<DJI_Group>(motors_.back()->commandId()));
    (void)groups_.back()->registerMotor(*motors_.back());
    (void)bus_->registerMotor(*groups_.back());
  }

  void receive(MonotonicTime now) {
    // The kernel's stamps are of the wall clock; this wake-up turns each into `now`.
    const WakeUp wake{.now = now, .previous = now, .realtime_offset = {}, .previous_offset = {}};
    const Reception reception = receiver_->receive(wake, frames_);
    for (std::size_t i = 0; i < reception.frame_count; ++i) bus_->dispatch(frames_[i]);
  }

  std::unique_ptr<fdCANbus> bus_;
  std::unique_ptr<sim::SimPort> port_;
  std::unique_ptr<CanReceiver> receiver_;
  std::vector<std::unique_ptr<DJI_Motor>> motors_;
  std::vector<std::unique_ptr<DJI_Group>> groups_;
  std::array<CanFrame, CanReceiver::kBatch> frames_{};
  MonotonicTime now_{std::chrono::seconds{100}};
  std::uint64_t ticks_ = 0;
};

}  // namespace rc10::test
