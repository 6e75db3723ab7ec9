#include <cmath>
#include <string>
#include <variant>

#include "drives/dji/dji_motor.hpp"

namespace rc10 {
namespace {

/// Shortest text of a number for a message: "20", "0.5".
std::string text(double value) {
  std::string digits = std::to_string(value);
  while (digits.back() == '0') digits.pop_back();
  if (digits.back() == '.') digits.pop_back();
  return digits;
}

bool isGain(float value) noexcept { return std::isfinite(value) && value >= 0.0F; }

/// Infinity is a legal "no separation".
bool isThreshold(float value) noexcept { return value >= 0.0F; }

bool allGains(const PID_Position::Config& c) noexcept {
  return isGain(c.kp) && isGain(c.ki) && isGain(c.kd) && isGain(c.integral_limit) &&
         isThreshold(c.integral_separation) && isGain(c.deadband) && isGain(c.output_limit) &&
         isGain(c.circular_period) && isGain(c.derivative_filter_hz);
}

bool allGains(const PID_Incremental::Config& c) noexcept {
  return isGain(c.kp) && isGain(c.ki) && isGain(c.kd) && isGain(c.deadband) && isGain(c.tracking_rad_s) &&
         isGain(c.output_limit) && isGain(c.derivative_filter_hz);
}

/// Error in the loops; empty: none.
std::string loopProblem(const CascadeConfig& loops) {
  if (!std::visit([](const auto& config) { return allGains(config); }, loops.velocity)) {
    return "velocity_pid: every gain and limit must be a finite number, 0 or more";
  }
  if (!allGains(loops.angle)) return "angle_pid: every gain and limit must be a finite number, 0 or more";
  if (!isGain(loops.velocity_limit_rpm)) return "velocity_limit_rpm must be a finite number, 0 or more";
  return {};
}

std::string referenceProblem(const MotorSettings& settings, const DjiModel& model) {
  const bool geared = settings.gear_ratio > 0.0 && settings.gear_ratio != model.gear_ratio;
  if (!std::isfinite(settings.zero_deg)) return "zero_deg must be a finite number";
  if (settings.zero_deg == 0.0) return {};
  if (!model.absolute_output || geared) {
    return "zero_deg needs an encoder on the output shaft (GM6020 without a gear); use zero: power_on or the "
           "zero request";
  }
  if (settings.zero_at_power_on) return "zero_deg and zero: power_on exclude each other";
  return {};
}

/// Error in the settings of a known model; empty: none.
std::string problem(const MotorSettings& settings, const DjiModel& model) {
  const DjiCommand command = djiSettings(settings.own).command;
  const std::string name{model.name};
  if (settings.id < 1 || settings.id > model.max_id) {
    return "id " + std::to_string(settings.id) + " is outside 1-" + std::to_string(model.max_id) + " of " +
           name;
  }
  const DjiCommandTable& table = model.command(command);
  if (!table.exists()) return "command: " + name + " obeys current only";
  if (!std::isfinite(settings.gear_ratio) || settings.gear_ratio < 0.0) {
    return "gear_ratio " + text(settings.gear_ratio) + " must be above 0, or 0 for the model's own " +
           text(model.gear_ratio);
  }
  if (settings.direction != 1 && settings.direction != -1) {
    return "direction " + std::to_string(settings.direction) + " must be 1 or -1";
  }
  if (!isGain(settings.effort_limit) || settings.effort_limit > table.full_scale) {
    const bool current = command == DjiCommand::kCurrent;
    return std::string{current ? "current_limit_a " : "voltage_limit_v "} +
           text(static_cast<double>(settings.effort_limit)) + " is outside 0-" +
           text(static_cast<double>(table.full_scale)) + (current ? " A" : " V") + " of " + name;
  }
  if (auto reason = referenceProblem(settings, model); !reason.empty()) return reason;
  return loopProblem(settings.loops);
}

}  // namespace

Result<void> DJI_Motor::check(const MotorSettings& settings) {
  const std::string who = "motor '" + settings.name + "': ";
  if (settings.name.empty()) return fail(who + "name is missing");
  const DjiModel* const model = findDjiModel(settings.model);
  if (model == nullptr) return fail(who + "model is missing: one of M3508, M2006, GM6020");
  if (auto reason = problem(settings, *model); !reason.empty()) return fail(who + reason);
  return {};
}

}  // namespace rc10
