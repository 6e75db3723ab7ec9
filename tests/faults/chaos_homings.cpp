// Homings that have the time to find their end: a random robot is disturbed long before.
#include <cmath>

#include <fmt/format.h>

#include "faults/chaos.hpp"

namespace rc10::test {
namespace {

// Values of a joint's output `state`.
constexpr double kHomes = 1.0;
constexpr double kFollows = 2.0;

}  // namespace

// The robot is made whole and its other clients let go of the motor. Then `home` rises. Often nothing else
// happens until the homing has ended, and then moves on the new reference follow.
void Chaos::home() {
  for (std::size_t module = 0; module < config_.modules.size(); ++module) {
    if (config_.modules[module].type->name() == "joint") homeJoint(module);
  }
}

void Chaos::homeJoint(std::size_t module) {
  const auto everyone = MotorSet{(1ULL << places_.size()) - 1};
  const auto ask = [&](double angle_deg, double home) {
    inputs_[module].given = true;
    inputs_[module].values.fill(kNoSignal);
    inputs_[module].values[0] = angle_deg;
    inputs_[module].values[1] = home;
  };
  for (std::size_t motor = 0; motor < places_.size(); ++motor) {
    repair(motor);
    busOf(motor).silence(driveOf(motor), false);
    busOf(motor).loseFrames(driveOf(motor), 0.0F);
    busOf(motor).stall(driveOf(motor), false);
  }
  repairBuses();
  for (auto& client : clients_) client.motors.reset();
  ask(kNoSignal, 0.0);
  // A stop of before has run down, and a message of before has ended.
  ticks(2'500);
  order(Operation::kClear, everyone);
  ticks(60);
  order(Operation::kEnable, everyone);
  ticks(400);
  ask(kNoSignal, 1.0);
  const auto for_ticks = choices_.of<std::uint64_t>({300, 1'500, 10'000, 10'000, 10'000});
  constexpr std::uint64_t kLook = 50;
  bool began = false;
  for (std::uint64_t i = 0; i < for_ticks && (i < kLook || stateOf(module) == kHomes); i += kLook) {
    ticks(kLook);
    began = began || stateOf(module) == kHomes;
  }
  if (began && stateOf(module) == kFollows) judgeReference(module);
  ask(choices_.of<double>({kNoSignal, 20.0, 90.0, 1e9}), 0.0);
  ticks(choices_.of<std::uint64_t>({1, 60, 1'500}));
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
