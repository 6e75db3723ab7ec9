#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "config/check/motor_draft.hpp"
#include "config/keys/settings.hpp"
#include "config/yaml/number_text.hpp"
#include "config/yaml/problem.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// One motor's settings on their way into its draft: what the parts of buildMotor() share.
struct MotorParse {
  const Settings& settings;
  MotorDraft& draft;
  Problems& problems;
  MotorTraits traits{};  ///< Once the model and its family's keys are known.

  [[nodiscard]] MotorSettings& motor() const noexcept { return draft.config.settings; }
  [[nodiscard]] const std::string& modelName() const noexcept { return motor().model; }

  [[nodiscard]] bool byVoltage() const noexcept { return traits.effort == CommandUnit::kVolt; }
  [[nodiscard]] const char* effortKey() const noexcept {
    return byVoltage() ? "voltage_limit_v" : "current_limit_a";
  }
  [[nodiscard]] bool knowsItsAngle() const noexcept { return traits.absolute && gear() == traits.gear_ratio; }
  [[nodiscard]] double gear() const noexcept { return gearRatioOf(motor(), traits); }
  /// For a model of unknown speed: the limit of the user, or 0.
  [[nodiscard]] double noLoadRpm() const noexcept {
    if (traits.no_load_rpm <= 0.0F) return static_cast<double>(motor().velocity_limit_rpm);
    return static_cast<double>(traits.no_load_rpm) * traits.gear_ratio / gear();
  }
  /// Highest threshold of speed that noise at the end of the reported range still shows, rpm of the shaft;
  /// infinite without such an end.
  [[nodiscard]] double highestThresholdRpm() const noexcept {
    constexpr double kBelowEnd = 0.98;
    if (!(traits.reported_rpm > 0.0F)) return std::numeric_limits<double>::infinity();
    return kBelowEnd * static_cast<double>(traits.reported_rpm) * traits.gear_ratio / gear();
  }
  [[nodiscard]] double torqueNmPerA() const noexcept {
    return static_cast<double>(traits.torque_nm_per_a) / traits.gear_ratio * gear();
  }

  /// Refuses a speed beyond which no feedback would tell that it is exceeded.
  void refuseUnseen(const GivenValue& given, double rpm, double most_rpm) {
    if (rpm <= most_rpm) return;
    problems.error(given.place(), given.path,
                   given.text() + " rpm is never seen to be exceeded: the " + modelName() +
                       " reports too low a speed for that; use at most " + numberText(std::floor(most_rpm)) +
                       " rpm");
  }
  /// Refuses a section whose upper angle is not above its lower one; one that is not given is not checked.
  void refuseUnordered(const Settings& section, std::string_view min_key, std::string_view max_key) {
    float min_deg = std::numeric_limits<float>::quiet_NaN();
    float max_deg = min_deg;
    section.read(min_key, min_deg);
    section.read(max_key, max_deg);
    const auto given = section.find(max_key);
    if (!given || !(min_deg >= max_deg)) return;  // NaN: not given
    problems.error(given->place(), given->path,
                   given->text() + " deg is not above " + std::string{min_key} + " (" +
                       section.text(min_key) + "); change one of them");
  }
};

}  // namespace rc10
