#include "module/joint_homing_check.hpp"

#include <chrono>
#include <cmath>
#include <string>

namespace rc10 {
namespace {

// Reports of the current in a standstill, so that one is surely of it.
constexpr int kReports = 2;

// The current tells a stop from a stiff place, if it was measured during the standstill.
Result<void> checkStop(const OwnValues& own, const RobotOutline::Motor& motor) {
  if (!motor.unreported_current_remedy.empty())
    return fail("homing: motor '" + motor.name +
                "' does not report its current, without which friction and gravity are not told from the "
                "stop; " +
                std::string{motor.unreported_current_remedy} + ", or use homing: switch");
  const auto least = std::chrono::ceil<std::chrono::milliseconds>(kReports * motor.current_period);
  if (std::chrono::milliseconds{own.integer("homing_stopped_ms")} >= least) return {};
  return fail("homing_stopped_ms: is shorter than two reports of the current of motor '" + motor.name +
              "'; write " + std::to_string(least.count()) + " or more, or let it come more often");
}

}  // namespace

Result<void> checkHoming(const OwnValues& own, const RobotOutline::Motor& motor) {
  const double rpm = own.number("homing_velocity_rpm");
  if (rpm == 0.0) return fail("homing_velocity_rpm: 0 finds nothing; its sign says where the end is");
  const auto limit_rpm = static_cast<double>(motor.velocity_limit_rpm);
  if (limit_rpm > 0.0 && std::fabs(rpm) > limit_rpm)
    return fail("homing_velocity_rpm: is more than motor '" + motor.name +
                "' turns; use less, see its velocity_limit_rpm and gear_ratio");
  const auto limit_a = static_cast<double>(motor.current_limit_a);
  if (limit_a > 0.0 && own.number("homing_current_a") > limit_a)
    return fail("homing_current_a: is more than current_limit_a of motor '" + motor.name +
                "'; the stop is pressed with all of it, so use less");
  if (own.number("homing_away_deg") <= own.number("homing_tolerance_deg"))
    return fail(
        "homing_away_deg: must be more than homing_tolerance_deg, or a second meeting with the end shows "
        "nothing");
  if (own.text("homing") == "stop") {
    if (auto seen = checkStop(own, motor); !seen) return seen;
  }
  const double home_deg = own.number("home_angle_deg");
  const bool behind = rpm < 0.0 ? home_deg >= motor.angle_max_deg : home_deg <= motor.angle_min_deg;
  if (behind)
    return fail(std::string{"home_angle_deg: no travel lies between it and "} +
                (rpm < 0.0 ? "angle_max_deg" : "angle_min_deg") + " of motor '" + motor.name +
                "'; see the sign of homing_velocity_rpm, which says where the end is");
  return {};
}

}  // namespace rc10
