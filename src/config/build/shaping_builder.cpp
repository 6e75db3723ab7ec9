#include "config/build/shaping_builder.hpp"

#include <cmath>
#include <string>

#include "app/units.hpp"

namespace rc10 {
namespace {

// Drives with loops of their own: a speed that stops within a tenth of a second, and the share of the
// no-load speed over which the effort comes down.
constexpr float kNativeApproach = 2.0F;
constexpr float kFullEffort = 0.2F;
// First step of an encoder that may be a turn astray, where nothing slows the way: farther is a matter of
// turns.
constexpr double kFirstStepDeg = 180.0;
// No supply makes a motor turn so fast.
constexpr float kBeyondNoLoad = 2.0F;
// A gimbal and a wheel live with it, and a hand has time.
constexpr double kSoftStartMs = 200.0;

// Warning of a motor that nothing enables before its zero is set.
void warnOfTurn(MotorParse& in) {
  const auto most = in.settings.find("angle_max_deg");
  const double travel_deg = in.motor().travel.max_deg - in.motor().travel.min_deg;
  if (!most || !in.knowsItsAngle() || in.settings.text("zero") == "power_on") return;
  if (!std::isfinite(travel_deg) || travel_deg < kDegPerTurn) return;
  in.problems.warning(most->place(), most->path,
                      "a travel of a turn or more: after each power-up its turn is not known, and it is "
                      "enabled only once `rc10ctl zero` has set its angle; make it shorter, or home it");
}

}  // namespace

void refuseWithoutBrake(MotorParse& in, std::string_view key) {
  const auto given = in.settings.find(key);
  const auto& modes = in.traits.modes;
  const bool pushes = modes.contains(ControlMode::kCurrent) || modes.contains(ControlMode::kVoltage) ||
                      modes.contains(ControlMode::kDuty);
  const ShapingConfig& shaping = in.draft.config.shaping;
  if (!given || !pushes || shaping.has_velocity_loop || shaping.knowsBrakingEffort()) return;
  const std::string remedy = in.settings.mentions("group") ? ", or use group: false" : "";
  in.problems.error(
      given->place(), given->path,
      "nothing could slow the motor down there: it has no velocity loop, and how fast a current "
      "turns it is not known; give velocity_limit_rpm" +
          remedy);
}

void readShaping(MotorParse& in) {
  ShapingConfig& shaping = in.draft.config.shaping;
  in.settings.read(in.byVoltage() ? "voltage_slew_v_per_s" : "current_slew_a_per_s",
                   shaping.effort_slew_per_s);
  in.settings.read("velocity_slew_rpm_per_s", shaping.velocity_slew_rpm_per_s);
  in.settings.read("angle_slew_deg_per_s", shaping.angle_slew_deg_per_s);
  in.settings.read("angle_min_deg", shaping.angle_min_deg);
  in.settings.read("angle_max_deg", shaping.angle_max_deg);
  in.motor().travel = {shaping.angle_min_deg, shaping.angle_max_deg};
  // A shaft without limits has no wrong turn, and moves over many turns are its trade.
  const bool limited = std::isfinite(shaping.angle_min_deg) || std::isfinite(shaping.angle_max_deg);
  if (limited && in.knowsItsAngle() && !in.settings.mentions("angle_slew_deg_per_s"))
    shaping.max_first_step_deg = kFirstStepDeg;
  in.settings.read("max_first_step_deg", shaping.max_first_step_deg);
  shaping.soft_start_s =
      static_cast<float>(in.settings.number("soft_start_ms").value_or(kSoftStartMs) / 1000.0);
  shaping.effort_full_scale = in.traits.effort_full_scale;
  shaping.springs = in.traits.modes.contains(ControlMode::kImpedance);
  shaping.effort_limit = effortLimitOf(in.motor(), in.traits.effort_full_scale);
  shaping.velocity_limit_rpm = in.motor().velocity_limit_rpm;
  // Without a limit of its own, with room for the error that a loop needs.
  if (!(shaping.velocity_limit_rpm > 0.0F) && in.noLoadRpm() > 0.0)
    shaping.velocity_limit_rpm = kBeyondNoLoad * static_cast<float>(in.noLoadRpm());
  shaping.has_velocity_loop = in.traits.modes.contains(ControlMode::kVelocity);
  if (in.traits.host_loops != nullptr) {
    shaping.approach_rpm_per_deg = kApproachOfAngleGain * in.motor().loops.angle.kp;
    shaping.lead_is_speed = true;
  } else {
    shaping.approach_rpm_per_deg = kNativeApproach;
  }
  if (in.traits.hostVelocityLoop()) {
    shaping.approach_effort_per_rpm = velocityKp(in.motor().loops);
    shaping.approach_effort_is_gain = true;
  } else if (in.noLoadRpm() > 0.0) {
    shaping.approach_effort_per_rpm =
        in.traits.effort_full_scale / (kFullEffort * static_cast<float>(in.noLoadRpm()));
  }
  if (in.traits.no_load_rpm > 0.0F) shaping.duty_per_rpm = 1.0F / static_cast<float>(in.noLoadRpm());
  if (!in.byVoltage() && in.torqueNmPerA() > 0.0)
    shaping.effort_per_nm = static_cast<float>(1.0 / in.torqueNmPerA());
  if (in.byVoltage() && in.noLoadRpm() > 0.0)
    shaping.effort_per_rpm = in.traits.effort_full_scale / static_cast<float>(in.noLoadRpm());
  in.refuseUnordered(in.settings, "angle_min_deg", "angle_max_deg");
  for (const char* key : {"angle_min_deg", "angle_max_deg"}) refuseWithoutBrake(in, key);
  warnOfTurn(in);
}

}  // namespace rc10
