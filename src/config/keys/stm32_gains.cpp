#include "config/keys/stm32_gains.hpp"

#include <cmath>

#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

constexpr double kMilliamperesPerAmpere = 1000.0;

}  // namespace

Result<double> stm32Number(const std::string& text) {
  const bool suffixed = text.size() > 1 && (text.back() == 'f' || text.back() == 'F');
  auto number = suffixed ? text.substr(0, text.size() - 1) : text;
  if (!number.empty() && number.back() == '.') number += '0';
  const auto value = parseNumber(number);
  if (!value || *value < 0.0) return fail("'" + text + "' is no number from 0 on");
  return *value;
}

Result<Stm32Pid> stm32Pid(std::span<const std::string> numbers) {
  if (numbers.size() < 3 || numbers.size() > 7) {
    return fail(
        "3 to 7 numbers are needed, in the order kp ki kd I_Outlimit isIOutlimit output_limit deadband");
  }
  Stm32Pid pid;
  double limits_integral = 0.0;
  double* const fields[] = {&pid.kp,          &pid.ki,           &pid.kd,      &pid.integral_limit,
                            &limits_integral, &pid.output_limit, &pid.deadband};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto text = numbers[i] == "true" ? "1" : numbers[i] == "false" ? "0" : numbers[i];
    const auto value = stm32Number(text);
    if (!value) return tl::unexpected(value.error());
    *fields[i] = *value;
  }
  pid.limits_integral = limits_integral != 0.0;
  return pid;
}

Converted<PID_Incremental::Config> convertSpeedGains(const Stm32Pid& pid, double td_ratio, double tick_s) {
  Converted<PID_Incremental::Config> out;
  // Per tick it adds kp (e - e1) + ki e + kd (e - 2 e1 + e2) mA, without a dt. Here the second is
  // ki e dt, and the third -kd (rate - rate1), where the rate is a change divided by dt.
  out.config.kp = static_cast<float>(pid.kp / kMilliamperesPerAmpere);
  out.config.ki = static_cast<float>(pid.ki / tick_s / kMilliamperesPerAmpere);
  out.config.kd = static_cast<float>(pid.kd * tick_s / kMilliamperesPerAmpere);
  out.config.deadband = static_cast<float>(pid.deadband);
  out.config.tracking_rad_s = static_cast<float>(td_ratio);
  out.config.output_limit = static_cast<float>(pid.output_limit / kMilliamperesPerAmpere);
  if (pid.kd > 0.0) {
    out.notes.emplace_back(
        "The derivative acts on the measurement only: a step of the target gives no kick any more.");
  }
  if (pid.limits_integral) {
    out.notes.emplace_back("I_Outlimit is left out: the library's PID_Incremental does not use it either.");
  }
  if (pid.output_limit == 0.0) {
    out.notes.emplace_back(
        "output_limit is 0 or not given: set current_limit_a, low at first (in the library 0 means no "
        "output).");
  }
  return out;
}

Converted<PID_Position::Config> convertAngleGains(const Stm32Pid& pid, double separation_deg) {
  Converted<PID_Position::Config> out;
  out.config.kp = static_cast<float>(pid.kp);
  out.config.kd = static_cast<float>(pid.kd);
  out.config.deadband = static_cast<float>(pid.deadband);
  out.config.output_limit = static_cast<float>(pid.output_limit);
  // Its integral acts below the threshold only, and so never with threshold 0, nor when it is bounded to 0.
  const bool integrates = separation_deg > 0.0 && !(pid.limits_integral && pid.integral_limit == 0.0);
  if (integrates) {
    out.config.ki = static_cast<float>(pid.ki);
    out.config.integral_separation = static_cast<float>(separation_deg);
    if (pid.limits_integral) out.config.integral_limit = static_cast<float>(pid.integral_limit);
    if (pid.ki > 0.0) {
      out.notes.emplace_back(
          "Beyond integral_separation_deg the integral stands still; the library cleared it.");
    }
  } else if (pid.ki > 0.0) {
    out.notes.emplace_back(
        separation_deg > 0.0 ? "ki is 0 here: with I_Outlimit 0 the library's integral never acted."
                             : "ki is 0 here: with I_SeparaThreshold 0 the library's integral never acted.");
  }
  if (pid.output_limit == 0.0) {
    out.notes.emplace_back(
        "output_limit is 0 or not given: set velocity_limit_rpm (in the library 0 means no output).");
  }
  return out;
}

ConvertedGains namedGains(const Converted<PID_Incremental::Config>& speed) {
  const auto& config = speed.config;
  ConvertedGains named{.section = "velocity_pid",
                       .type = "incremental",
                       .gains = {{"kp_a_per_rpm", config.kp, {}},
                                 {"ki_a_per_rpm_s", config.ki, "per second"},
                                 {"kd_a_s_per_rpm", config.kd, {}},
                                 {"deadband_rpm", config.deadband, {}}},
                       .current_limit_a = config.output_limit,
                       .notes = speed.notes};
  if (config.tracking_rad_s > 0.0F)
    named.gains.push_back({"target_bandwidth_rad_s", config.tracking_rad_s, "td_ratio"});
  return named;
}

ConvertedGains namedGains(const Converted<PID_Position::Config>& angle) {
  const auto& config = angle.config;
  ConvertedGains named{.section = "angle_pid",
                       .type = {},
                       .gains = {{"kp_rpm_per_deg", config.kp, {}},
                                 {"ki_rpm_per_deg_s", config.ki, {}},
                                 {"kd_rpm_s_per_deg", config.kd, {}},
                                 {"deadband_deg", config.deadband, {}}},
                       .current_limit_a = 0.0F,
                       .notes = angle.notes};
  const auto optional = [&named](std::string_view key, float value) {
    if (value > 0.0F) named.gains.push_back({key, value, {}});
  };
  optional("velocity_limit_rpm", config.output_limit);
  optional("integral_limit_rpm", config.integral_limit);
  optional("integral_separation_deg", config.integral_separation);
  return named;
}

std::string yamlLines(const ConvertedGains& gains) {
  std::string text;
  for (const auto& note : gains.notes) text += "# " + note + "\n";
  if (gains.current_limit_a > 0.0F) text += "current_limit_a: " + numberText(gains.current_limit_a) + "\n";
  text += gains.section + ":\n";
  if (!gains.type.empty()) text += "  type: " + gains.type + "\n";
  for (const auto& gain : gains.gains) {
    text += "  " + std::string{gain.key} + ": " + numberText(gain.value);
    if (!gain.comment.empty()) text += "  # " + std::string{gain.comment};
    text += "\n";
  }
  return text;
}

}  // namespace rc10
