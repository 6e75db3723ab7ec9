#include "sim/motor_physics.hpp"

#include <algorithm>
#include <cmath>

#include "app/units.hpp"

namespace rc10::sim {
namespace {

// Estimate of a hand on a shaft: it pulls with all its torque where the shaft lags so much, and follows no
// faster than the steps of the simulation can.
constexpr double kHandLagDeg = 1.0;
constexpr double kMostHandRadPerS = 400.0;
// A shaft that still turns when it should be let go (heavy, or led faster than its motor's no-load speed)
// is led on, for so long at most: let go, it would run away.
constexpr double kLedOnS = 5.0;
constexpr double kAtRestRadPerS = 0.05;  // half a rpm

}  // namespace

MotorPhysics::MotorPhysics(const MotorParameters& parameters, double initial_angle_deg) noexcept
    : parameters_(parameters), temperature_c_(parameters.ambient_c) {
  place(initial_angle_deg);
}

void MotorPhysics::setParameters(const MotorParameters& parameters) noexcept {
  const double before = parameters_.totalInertia();
  parameters_ = parameters;
  velocity_rad_s_ *= std::min(before / parameters_.totalInertia(), 1.0);
}

void MotorPhysics::place(double output_deg) noexcept {
  const double turns = output_deg / kDegPerTurn * parameters_.gear_ratio;
  rotor_turns_ = static_cast<std::int64_t>(std::floor(turns));
  rotor_fraction_ = turns - std::floor(turns);
}

void MotorPhysics::step(const WindingCommand& command, Duration dt) noexcept {
  if (dt <= Duration::zero()) return;
  const auto steps = (dt + kLongestStep - Duration{1}) / kLongestStep;
  const double dt_s = std::chrono::duration<double>(dt).count() / static_cast<double>(steps);
  for (auto i = steps; i > 0; --i) substep(command, dt_s);
}

void MotorPhysics::substep(const WindingCommand& command, double dt_s) noexcept {
  stepCurrent(command, dt_s);
  stepMotion(dt_s);
  stepStops();
  stepHeat(dt_s);
  stepSpeedMeasurement(dt_s);
}

void MotorPhysics::stepCurrent(const WindingCommand& command, double dt_s) noexcept {
  const auto& p = parameters_;
  const double back_emf_v = p.back_emf_vs_per_rad * velocity_rad_s_ * p.gear_ratio;
  const auto current_at = [&](double volts) { return (volts - back_emf_v) / p.resistance_ohm; };

  const bool by_voltage = command.kind == WindingCommand::Kind::kVoltage;
  const double wanted_a =
      by_voltage ? current_at(std::clamp(command.value, -p.supply_v, p.supply_v)) : command.value;
  const double limited_a = std::clamp(wanted_a, -p.current_limit_a, p.current_limit_a);
  const double lag_s = by_voltage ? p.winding_lag_s : p.current_lag_s;
  current_a_ += (limited_a - current_a_) * dt_s / (lag_s + dt_s);

  // The supply drives no more than this against the back-EMF: it is what limits the speed. Above the
  // no-load speed the current is negative, as through the bridge's diodes: a driven motor brakes.
  if (!by_voltage) current_a_ = std::clamp(current_a_, current_at(-p.supply_v), current_at(p.supply_v));
  current_a_ = std::clamp(current_a_, -p.current_limit_a, p.current_limit_a);
}

void MotorPhysics::stepMotion(double dt_s) noexcept {
  if (stalled_) {
    velocity_rad_s_ = 0.0;
    return;
  }
  const auto& p = parameters_;
  const double inertia = p.totalInertia();
  double torque_nm = outputTorqueNm() - p.output_load_nm + stepHand(dt_s);
  if (p.output_gravity_nm != 0.0) {
    torque_nm -= p.output_gravity_nm * std::sin((outputAngleDeg() - p.output_hangs_at_deg) * kRadPerDeg);
  }
  const double previous_rad_s = velocity_rad_s_;

  // Friction is implicit: viscous friction is stable for any step, and Coulomb friction takes away at
  // most the whole speed, so the shaft comes to rest, stays there until the torque exceeds it, and
  // never chatters around zero.
  const double divisor = inertia + dt_s * p.output_viscous_nms_per_rad;
  const double free_rad_s = (inertia * previous_rad_s + dt_s * torque_nm) / divisor;
  const double coulomb_rad_s = dt_s * p.output_coulomb_nm / divisor;
  velocity_rad_s_ = std::copysign(std::max(std::abs(free_rad_s) - coulomb_rad_s, 0.0), free_rad_s);

  const double mean_rad_s = 0.5 * (previous_rad_s + velocity_rad_s_);
  rotor_fraction_ += mean_rad_s * p.gear_ratio / kRadPerTurn * dt_s;
  const double whole = std::floor(rotor_fraction_);
  rotor_fraction_ -= whole;
  rotor_turns_ += static_cast<std::int64_t>(whole);
  if (rotor_fraction_ >= 1.0) {  // -1e-17 - floor(-1e-17) rounds to 1
    rotor_fraction_ = 0.0;
    ++rotor_turns_;
  }
}

void MotorPhysics::take(const Hand& hand) noexcept {
  const double from_deg = outputAngleDeg();
  const double most_deg_s = hand.speed_rpm * kDegPerSPerRpm;
  // Half of its torque is left for friction and the load.
  const double acceleration_deg_s2 = std::min(most_deg_s / std::chrono::duration<double>(Hand::kRamp).count(),
                                              0.5 * hand.torque_nm / parameters_.totalInertia() / kRadPerDeg);
  const double moving_s = std::abs(hand.by_deg) / most_deg_s + most_deg_s / acceleration_deg_s2;
  grip_ = {.held = true,
           .at_deg = from_deg,
           .to_deg = from_deg + hand.by_deg,
           .most_deg_s = most_deg_s,
           .acceleration_deg_s2 = acceleration_deg_s2,
           .torque_nm = hand.torque_nm,
           .left_s = moving_s + std::chrono::duration<double>(hand.hold + Hand::kSettle).count()};
}

void MotorPhysics::moveHand(double dt_s) noexcept {
  const double way_deg = grip_.to_deg - grip_.at_deg;
  // As fast as it can still stop from.
  const double most_deg_s =
      std::min(grip_.most_deg_s, std::sqrt(2.0 * grip_.acceleration_deg_s2 * std::abs(way_deg)));
  const double gained_deg_s = std::abs(grip_.deg_s) + grip_.acceleration_deg_s2 * dt_s;
  grip_.deg_s = std::copysign(std::min(gained_deg_s, most_deg_s), way_deg);
  if (std::abs(way_deg) <= std::abs(grip_.deg_s) * dt_s) {
    grip_.at_deg = grip_.to_deg;
    grip_.deg_s = 0.0;
  } else {
    grip_.at_deg += grip_.deg_s * dt_s;
  }
}

// Critically damped spring between the shaft and a point that goes its way. Where it would be stretched
// beyond the hand's torque the hand slips, so that no shaft is whirled back over the turns that it ran away.
double MotorPhysics::stepHand(double dt_s) noexcept {
  if (!grip_.held) return 0.0;
  grip_.left_s -= dt_s;
  const bool turns = std::abs(velocity_rad_s_) > kAtRestRadPerS;
  grip_.held = grip_.left_s > 0.0 || (turns && grip_.left_s > -kLedOnS);
  moveHand(dt_s);
  const double inertia = parameters_.totalInertia();
  const double natural_rad_s =
      std::min(std::sqrt(grip_.torque_nm / (kHandLagDeg * kRadPerDeg) / inertia), kMostHandRadPerS);
  const double stiffness_nm_per_rad = inertia * natural_rad_s * natural_rad_s;
  const double most_lag_deg = grip_.torque_nm / stiffness_nm_per_rad / kRadPerDeg;
  const double angle_deg = outputAngleDeg();
  grip_.at_deg = std::clamp(grip_.at_deg, angle_deg - most_lag_deg, angle_deg + most_lag_deg);
  const double friction_nm =
      grip_.deg_s == 0.0 ? 0.0 : std::copysign(parameters_.output_coulomb_nm, grip_.deg_s);
  const double pull_nm = stiffness_nm_per_rad * (grip_.at_deg - angle_deg) * kRadPerDeg +
                         2.0 * inertia * natural_rad_s * (grip_.deg_s * kRadPerDeg - velocity_rad_s_) +
                         friction_nm;
  return std::clamp(pull_nm, -grip_.torque_nm, grip_.torque_nm);
}

// A stop is rigid and takes all of the speed: nothing bounces.
void MotorPhysics::stepStops() noexcept {
  const double angle_deg = outputAngleDeg();
  const double within_deg =
      std::clamp(angle_deg, parameters_.output_stop_min_deg, parameters_.output_stop_max_deg);
  if (within_deg == angle_deg) return;
  place(within_deg);
  const bool outwards = (angle_deg > within_deg) == (velocity_rad_s_ > 0.0);
  if (outwards) velocity_rad_s_ = 0.0;
}

void MotorPhysics::stepHeat(double dt_s) noexcept {
  const auto& p = parameters_;
  const double heating_w = p.resistance_ohm * current_a_ * current_a_;
  const double cooling_w = (temperature_c_ - p.ambient_c) / p.thermal_resistance_k_per_w;
  temperature_c_ += (heating_w - cooling_w) * dt_s / p.heat_capacity_j_per_k;
}

void MotorPhysics::stepSpeedMeasurement(double dt_s) noexcept {
  measured_velocity_rad_s_ +=
      (velocity_rad_s_ - measured_velocity_rad_s_) * dt_s / (parameters_.speed_lag_s + dt_s);
}

double MotorPhysics::rotorRpm() const noexcept { return outputRpm() * parameters_.gear_ratio; }

double MotorPhysics::measuredRotorRpm() const noexcept {
  return measured_velocity_rad_s_ * kRpmPerRadPerS * parameters_.gear_ratio;
}

double MotorPhysics::outputAngleDeg() const noexcept {
  return (static_cast<double>(rotor_turns_) + rotor_fraction_) * kDegPerTurn / parameters_.gear_ratio;
}

double MotorPhysics::outputRpm() const noexcept { return velocity_rad_s_ * kRpmPerRadPerS; }

double MotorPhysics::outputTorqueNm() const noexcept {
  return current_a_ * parameters_.torque_nm_per_a * parameters_.gear_ratio;
}

double MotorPhysics::kineticEnergyJ() const noexcept {
  return 0.5 * parameters_.totalInertia() * velocity_rad_s_ * velocity_rad_s_;
}

}  // namespace rc10::sim
