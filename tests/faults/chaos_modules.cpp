// Homings and holds of modules that have the time to find their end: a random robot is disturbed long before.
#include <cmath>

#include <fmt/format.h>

#include "faults/chaos.hpp"

namespace rc10::test {
namespace {

// Values of a joint's output `state`.
constexpr double kHomes = 1.0;
constexpr double kFollows = 2.0;

}  // namespace

void Chaos::useModules() {
  for (std::size_t module = 0; module < config_.modules.size(); ++module) {
    const auto type = config_.modules[module].type->name();
    if (type == "joint") homeJoint(module);
    if (type == "gimbal") leaveGimbal(module);
  }
}

// The robot is whole, its other clients have let go of it, and all motors are on.
void Chaos::makeWhole() {
  const auto everyone = MotorSet{(1ULL << places_.size()) - 1};
  for (std::size_t motor = 0; motor < places_.size(); ++motor) {
    repair(motor);
    busOf(motor).silence(driveOf(motor), false);
    busOf(motor).loseFrames(driveOf(motor), 0.0F);
    busOf(motor).stall(driveOf(motor), false);
  }
  repairBuses();
  for (auto& client : clients_) client.motors.reset();
  // A stop of before has run down, and a message of before has ended.
  ticks(2'500);
  order(Operation::kClear, everyone);
  ticks(60);
  order(Operation::kEnable, everyone);
  ticks(400);
}

void Chaos::ask(std::size_t module, double first, double second) {
  inputs_[module].given = true;
  inputs_[module].values.fill(kNoSignal);
  inputs_[module].values[0] = first;
  inputs_[module].values[1] = second;
}

// Its client falls silent, and comes back after its hold has ended, or just before.
void Chaos::leaveGimbal(std::size_t module) {
  for (std::size_t other = 0; other < config_.modules.size(); ++other)
    if (config_.modules[other].type->name() == "imu") ask(other, 0.0, 0.0);
  ask(module, kNoSignal, kNoSignal);
  makeWhole();
  ask(module, choices_.of<double>({0.0, 20.0, -60.0}), choices_.of<double>({0.0, 10.0}));
  ticks(300);
  inputs_[module].given = false;
  ticks(choices_.of<std::uint64_t>({900, 1'500, 3'000}));
}

// `home` rises. Often nothing else happens until the homing has ended, and then moves on the new reference
// follow.
void Chaos::homeJoint(std::size_t module) {
  ask(module, kNoSignal, 0.0);
  makeWhole();
  ask(module, kNoSignal, 1.0);
  const auto for_ticks = choices_.of<std::uint64_t>({300, 1'500, 10'000, 10'000, 10'000});
  constexpr std::uint64_t kLook = 50;
  bool began = false;
  for (std::uint64_t i = 0; i < for_ticks && (i < kLook || stateOf(module) == kHomes); i += kLook) {
    ticks(kLook);
    began = began || stateOf(module) == kHomes;
  }
  if (began && stateOf(module) == kFollows) judgeReference(module);
  ask(module, choices_.of<double>({kNoSignal, 20.0, 90.0, 1e9}), 0.0);
  ticks(choices_.of<std::uint64_t>({1, 60, 1'500}));
  // Every client is silent: its hold ends.
  if (choices_.oneIn(2)) return;
  for (auto& inputs : inputs_) inputs.given = false;
  ticks(choices_.of<std::uint64_t>({900, 1'500, 3'000}));
}

double Chaos::stateOf(std::size_t module) const { return robot_->snapshot().modules[module].outputs[0]; }

// The shaft knows where its stop is.
void Chaos::judgeReference(std::size_t module) {
  constexpr double kToleranceDeg = 3.0;  // of two meetings with the stop, and the way of some ticks
  const auto& own = config_.modules[module].settings.own;
  const std::size_t motor = own.motor("motor");
  const auto& shaft = busOf(motor).motor(driveOf(motor));
  const auto& stops = shaft.parameters();
  const double stop_deg =
      own.number("homing_velocity_rpm") < 0.0 ? stops.output_stop_min_deg : stops.output_stop_max_deg;
  const double true_deg = shaft.outputAngleDeg() - stop_deg + own.number("home_angle_deg");
  const double error_deg = robot_->motor(motor).feedback.total_angle_deg - true_deg;
  if (std::fabs(error_deg) > kToleranceDeg)
    throw Violation{fmt::format("tick {}: the reference found is wrong by {} degrees", tick_, error_deg)};
}

}  // namespace rc10::test
