#include "sim/servo_drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/units.hpp"

namespace rc10::sim {
namespace {

// Loops of a drive that somebody has tuned for its load: stiff, and without overshoot.
constexpr double kVelocityBandwidthRadS = 120.0;
constexpr double kPositionGainPerS = 20.0;
constexpr double kCurrentLagSeconds = 0.0003;
constexpr double kWindingLagSeconds = 0.0005;
// Share of full scale, for what a model's table leaves open.
constexpr double kFrictionShare = 0.02;
constexpr double kRatedShare = 0.4;
constexpr double kMechanicalLagSeconds = 0.03;

}  // namespace

MotorParameters servoParameters(const MotorTraits& traits, double gear_ratio,
                                const MotorLoad& load) noexcept {
  const double own_gear = traits.gear_ratio;
  const double supply_v = static_cast<double>(traits.nominal_v);
  const double no_load_rpm = traits.no_load_rpm > 0.0F ? static_cast<double>(traits.no_load_rpm) : 300.0;
  const double no_load_rad_s = no_load_rpm * own_gear * kRadPerSPerRpm;  // of the rotor

  MotorParameters p;
  p.gear_ratio = gear_ratio;
  p.supply_v = supply_v;
  // Without friction, back-EMF equals the supply at no-load speed.
  p.back_emf_vs_per_rad = supply_v * (1.0 - kFrictionShare) / no_load_rad_s;
  p.torque_nm_per_a = traits.torque_nm_per_a > 0.0F ? static_cast<double>(traits.torque_nm_per_a) / own_gear
                                                    : p.back_emf_vs_per_rad;
  p.current_limit_a = traits.effort == CommandUnit::kAmpere && traits.effort_full_scale > 0.0F
                          ? static_cast<double>(traits.effort_full_scale)
                          : 10.0;
  p.resistance_ohm = traits.phase_resistance_ohm > 0.0F ? static_cast<double>(traits.phase_resistance_ohm)
                                                        : 0.3 * supply_v / p.current_limit_a;
  p.current_lag_s = kCurrentLagSeconds;
  p.winding_lag_s = kWindingLagSeconds;
  p.speed_lag_s = kSpeedLagSeconds;

  const double full_torque_nm = p.torque_nm_per_a * p.current_limit_a;  // of the rotor
  p.inertia_kg_m2 = traits.rotor_inertia_kg_m2 > 0.0F
                        ? static_cast<double>(traits.rotor_inertia_kg_m2)
                        : full_torque_nm * kMechanicalLagSeconds / no_load_rad_s;
  p.output_inertia_kg_m2 = orDefault(load.inertia_kg_m2, p.inertia_kg_m2 * gear_ratio * gear_ratio);
  const double friction_nm = kFrictionShare * full_torque_nm * gear_ratio;
  p.output_coulomb_nm = orDefault(load.coulomb_nm, 0.5 * friction_nm);
  p.output_viscous_nms_per_rad =
      orDefault(load.viscous_nms_per_rad, 0.5 * friction_nm * gear_ratio / no_load_rad_s);
  hang(load, p);

  const double rated_a = kRatedShare * p.current_limit_a;
  p.thermal_resistance_k_per_w = (kWindingC - kRoomC) / (p.resistance_ohm * rated_a * rated_a);
  p.heat_capacity_j_per_k = 120.0;
  p.ambient_c = kRoomC;
  return p;
}

ServoDrive::ServoDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load,
                       std::vector<FrameFilter> sends)
    : name_(settings.name),
      traits_(traits),
      gear_ratio_(gearRatioOf(settings, traits)),
      drive_per_output_(gear_ratio_ / traits.gear_ratio),
      load_(load),
      sends_(std::move(sends)),
      physics_(servoParameters(traits, gear_ratio_, load), static_cast<double>(load.initial_angle_deg)) {
  physics_.stall(load_.stalled);
}

void ServoDrive::enter(Mode mode) noexcept {
  if (mode_ != mode) integral_nm_ = 0.0;
  mode_ = mode;
  torque_ff_nm_ = 0.0;
  torque_limit_nm_ = 0.0;
}

void ServoDrive::current(double rotor_a) noexcept {
  enter(Mode::kCurrent);
  value_ = rotor_a;
}

void ServoDrive::voltage(double volts) noexcept {
  enter(Mode::kVoltage);
  value_ = volts;
}

void ServoDrive::shortWinding() noexcept { voltage(0.0); }

void ServoDrive::torque(double nm) noexcept {
  enter(Mode::kTorque);
  value_ = nm;
}

void ServoDrive::velocity(double rpm, double torque_ff_nm, double torque_limit_nm) noexcept {
  enter(Mode::kVelocity);
  value_ = rpm;
  torque_ff_nm_ = torque_ff_nm;
  torque_limit_nm_ = torque_limit_nm;
}

void ServoDrive::position(double deg, double limit_rpm, double torque_limit_nm) noexcept {
  enter(Mode::kPosition);
  value_ = deg;
  value_rpm_ = limit_rpm;
  torque_limit_nm_ = torque_limit_nm;
}

void ServoDrive::impedance(double deg, double rpm, double stiffness_nm_per_rad, double damping_nms_per_rad,
                           double torque_ff_nm) noexcept {
  enter(Mode::kImpedance);
  value_ = deg;
  value_rpm_ = rpm;
  stiffness_ = stiffness_nm_per_rad;
  damping_ = damping_nms_per_rad;
  torque_ff_nm_ = torque_ff_nm;
}

double ServoDrive::velocityLoop(double wanted_rpm, double dt_s) noexcept {
  const auto& p = physics_.parameters();
  const double full_nm = p.torque_nm_per_a * p.current_limit_a * traits_.gear_ratio;
  const double limit_nm = torque_limit_nm_ > 0.0 ? std::min(torque_limit_nm_, full_nm) : full_nm;
  // Inertia as the drive's output sees it.
  const double inertia = p.totalInertia() / (drive_per_output_ * drive_per_output_);
  const double gain = inertia * kVelocityBandwidthRadS;
  const double error = (wanted_rpm - driveRpm()) * kRadPerSPerRpm;
  const double grown = integral_nm_ + gain * kVelocityBandwidthRadS / 4.0 * error * dt_s;
  const double wanted_nm = gain * error + grown + torque_ff_nm_;
  const double nm = std::clamp(wanted_nm, -limit_nm, limit_nm);
  if (nm == wanted_nm) integral_nm_ = grown;
  return nm;
}

WindingCommand ServoDrive::winding(double dt_s) noexcept {
  const double nm_per_a =
      physics_.parameters().torque_nm_per_a * traits_.gear_ratio;  // at the drive's output
  const auto amperes = [](double a) {
    return WindingCommand{.kind = WindingCommand::Kind::kCurrent, .value = a};
  };
  switch (mode_) {
    case Mode::kReleased: break;
    case Mode::kCurrent: return amperes(value_);
    case Mode::kVoltage: return {.kind = WindingCommand::Kind::kVoltage, .value = value_};
    case Mode::kTorque: return amperes(value_ / nm_per_a);
    case Mode::kVelocity: return amperes(velocityLoop(value_, dt_s) / nm_per_a);
    case Mode::kPosition: {
      const double own_rpm = static_cast<double>(traits_.no_load_rpm);
      const double limit_rpm = value_rpm_ > 0.0 ? value_rpm_ : (own_rpm > 0.0 ? own_rpm : 1e6);
      const double wanted_rpm = kPositionGainPerS * (value_ - driveAngleDeg()) / kDegPerSPerRpm;
      return amperes(velocityLoop(std::clamp(wanted_rpm, -limit_rpm, limit_rpm), dt_s) / nm_per_a);
    }
    case Mode::kImpedance: {
      const double nm = stiffness_ * (value_ - driveAngleDeg()) * kRadPerDeg +
                        damping_ * (value_rpm_ - driveRpm()) * kRadPerSPerRpm + torque_ff_nm_;
      return amperes(nm / nm_per_a);
    }
  }
  return amperes(0.0);
}

void ServoDrive::step(Duration dt) noexcept {
  // The drive's loops run as often as the physics steps.
  for (Duration left = dt; left > Duration::zero();) {
    const Duration part = std::min(left, MotorPhysics::kLongestStep);
    physics_.step(winding(std::chrono::duration<double>(part).count()), part);
    left -= part;
  }
  elapsed_ += std::max(dt, Duration::zero());
}

double ServoDrive::driveAngleDeg() const noexcept {
  return encoder_sign_ * physics_.outputAngleDeg() * drive_per_output_ - zero_deg_;
}

double ServoDrive::driveRpm() const noexcept { return rotorRpm() / traits_.gear_ratio; }

double ServoDrive::driveTorqueNm() const noexcept {
  return physics_.currentA() * physics_.parameters().torque_nm_per_a * traits_.gear_ratio;
}

void ServoDrive::zeroAt(double deg) noexcept { zero_deg_ += driveAngleDeg() - deg; }

void ServoDrive::setLoad(const MotorLoad& load) noexcept {
  load_ = load;
  physics_.setParameters(servoParameters(traits_, gear_ratio_, load));
  physics_.stall(load.stalled);
}

void ServoDrive::answer(const CanFrame& frame) noexcept {
  if (answer_count_ < answers_.size()) answers_[answer_count_++] = frame;
}

std::size_t ServoDrive::answers(std::span<CanFrame> out) noexcept {
  if (stores()) return 0;
  const std::size_t count = std::min(answer_count_, out.size());
  std::copy_n(answers_.begin(), count, out.begin());
  answer_count_ = 0;
  return count;
}

}  // namespace rc10::sim
