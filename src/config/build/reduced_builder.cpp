#include "config/build/reduced_builder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "app/mode_words.hpp"
#include "config/build/shaping_builder.hpp"
#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

// A loop overshoots its target, and measured speeds are noisy.
constexpr float kTolerance = 0.25F;
// For a motor of unknown fastest speed.
constexpr float kFullOfReduced = 4.0F;

/// Fastest speed of a target.
float fullRpm(const MotorParse& in) {
  if (in.motor().velocity_limit_rpm > 0.0F) return in.motor().velocity_limit_rpm;
  if (in.noLoadRpm() > 0.0) return static_cast<float>(in.noLoadRpm());
  return kFullOfReduced * in.draft.config.reduced.velocity_rpm;
}

void readVelocity(MotorParse& in) {
  ReducedConfig& reduced = in.draft.config.reduced;
  const auto given = in.settings.find("reduced_velocity_rpm");
  if (!given) return;
  in.settings.read("reduced_velocity_rpm", reduced.velocity_rpm);
  refuseWithoutBrake(in, "reduced_velocity_rpm");
  reduced.full_rpm = fullRpm(in);
  reduced.tolerance_rpm = kTolerance * reduced.velocity_rpm + in.draft.config.standstill_rpm;
  const double most_rpm = (in.highestThresholdRpm() - static_cast<double>(in.draft.config.standstill_rpm)) /
                          (1.0 + static_cast<double>(kTolerance));
  in.refuseUnseen(*given, static_cast<double>(reduced.velocity_rpm), most_rpm);
  in.settings.read("velocity_slew_rpm_per_s", reduced.slew_rpm_per_s);
  if (const auto within_ms = in.settings.number("reduced_within_ms"))
    reduced.within = std::chrono::milliseconds{static_cast<int>(*within_ms)};
  if (!(reduced.velocity_rpm < reduced.full_rpm)) {
    return in.problems.error(given->place(), given->path,
                             given->text() + " rpm is not below the " +
                                 numberText(std::round(reduced.full_rpm)) +
                                 " rpm that the motor may have anyway; lower it");
  }
  if (!(reduced.slew_rpm_per_s > 0.0F)) return;
  const double down_s =
      static_cast<double>((reduced.full_rpm - reduced.velocity_rpm) / reduced.slew_rpm_per_s);
  if (down_s <= static_cast<double>(seconds(reduced.within))) return;
  const auto within = in.settings.find("reduced_within_ms");
  const auto& wrong = within ? *within : *given;
  in.problems.error(wrong.place(), wrong.path,
                    "velocity_slew_rpm_per_s needs " + numberText(std::ceil(down_s * 1000.0)) +
                        " ms from full to reduced speed, more than reduced_within_ms (" +
                        std::to_string(reduced.within / std::chrono::milliseconds{1}) +
                        "): each change would be a fault; raise one of the two");
}

void readEffort(MotorParse& in) {
  const char* key = in.byVoltage() ? "reduced_voltage_v" : "reduced_current_a";
  const auto given = in.settings.find(key);
  if (!given) return;
  float effort = 0.0F;
  in.settings.read(key, effort);
  const float limit = effortLimitOf(in.motor(), in.traits.effort_full_scale);
  if (const std::string modes = modeWords(in.traits.own_loops); !modes.empty()) {
    in.problems.warning(given->place(), given->path,
                        "does not act in " + modes +
                            ", whose loops in the drive obey its own maximum; lower that with the vendor's "
                            "tool, or keep to other targets while a person is near");
  }
  if (effort < limit) {
    in.draft.config.reduced.effort_share = effort / limit;
    return;
  }
  const char* unit = in.byVoltage() ? " V" : " A";
  in.problems.error(given->place(), given->path,
                    given->text() + unit + " is not below the " + numberText(limit) + unit +
                        " that the motor may have anyway; lower it");
}

}  // namespace

void readReduced(MotorParse& in) {
  readVelocity(in);
  readEffort(in);
}

void checkModeInput(const Settings& top, const RobotConfig& robot, Problems& problems) {
  const auto mode = top.find("mode_gpio");
  bool any = false;
  for (std::size_t bus = 0; bus < robot.buses.size(); ++bus) {
    const auto& motors = robot.buses[bus].motors;
    for (std::size_t i = 0; i < motors.size(); ++i) {
      if (!motors[i].reduced.any()) continue;
      any = true;
      if (top.mentions("mode_gpio")) continue;
      problems.error(motors[i].place, joinPath(joinPath(joinPath("buses", bus), "motors"), i),
                     "nothing ever asks for the reduced limits of " + inQuotes(motors[i].name()) +
                         "; add mode_gpio, or remove them");
    }
  }
  if (any || !mode || problems.hasErrors()) return;  // of a motor that is wrong the limits are not known
  problems.error(
      mode->place(), mode->path,
      "no motor has a limit to reduce; add reduced_velocity_rpm or reduced_current_a (reduced_voltage_v) to "
      "those that a person may come near, or remove it");
}

}  // namespace rc10
