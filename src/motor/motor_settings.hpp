#pragma once

#include <string>

#include "app/time.hpp"
#include "motor/cascade.hpp"
#include "motor/first_angle.hpp"
#include "motor/own_values.hpp"

namespace rc10 {

/// Share by which a reported speed may be off. The nearest two scales of one series are 30 % apart
/// (RobStride: 33 and 44 rad/s).
inline constexpr double kScaleError = 0.2;

/// One motor as configured, for its family to build. At the output shaft.
struct MotorSettings {
  std::string name;
  std::string model;
  int id = 0;                        ///< As set on the drive.
  double gear_ratio = 0.0;           ///< Rotor turns per turn of the output shaft; 0: the model's own.
  int direction = 1;                 ///< -1: mounted the other way round.
  float effort_limit = 0.0F;         ///< A or V, see MotorTraits::effort; 0: the model's full scale.
  float velocity_limit_rpm = 0.0F;   ///< Bounds every velocity target. 0: none.
  double zero_deg = 0.0;             ///< Output angle of an absolute encoder that is to read 0.
  bool zero_at_power_on = false;     ///< The position of the first sample is 0.
  Travel travel{};                   ///< Tells the turn of an absolute encoder at power-up.
  CascadeConfig loops;               ///< Loops of the host; meaningless where MotorTraits has none.
  int feedback_hz = 0;               ///< As set on the drive, or the rate of questions.
  int tick_hz = 1000;                ///< Tick rate of the scheduler.
  int command_divider = 1;           ///< A command is sent in every n-th tick,
  int command_phase = 0;             ///< offset by so many ticks: 0 to n - 1.
  double scale_error = kScaleError;  ///< See MotorTraits::scaled_speed; 0: not compared.
  float own_limit_a = 0.0F;          ///< Current limit of MotorTraits::own_loops; 0: unknown.
  OwnValues own;
};

/// Rotor turns per turn of the output shaft: as configured, or the model's own. Of settings and traits, or of
/// a family's own structs with these members.
template <typename Settings, typename Traits>
[[nodiscard]] constexpr double gearRatioOf(const Settings& settings, const Traits& model) noexcept {
  return settings.gear_ratio > 0.0 ? settings.gear_ratio : model.gear_ratio;
}

/// Effort limit of a motor: as configured, or the full scale of its model. A or V. Of settings, or of a
/// family's own struct with this member.
template <typename Settings>
[[nodiscard]] constexpr float effortLimitOf(const Settings& settings, float full_scale) noexcept {
  return settings.effort_limit > 0.0F ? settings.effort_limit : full_scale;
}

/// Period of the reported current. A drive that is asked tells it in each answer, its angle perhaps not.
template <typename Traits>
[[nodiscard]] constexpr Duration currentPeriodOf(const MotorSettings& settings,
                                                 const Traits& model) noexcept {
  if (model.signed_current_hz > 0) return periodOf(model.signed_current_hz);
  if (model.asked) return settings.command_divider * periodOf(settings.tick_hz);
  return periodOf(settings.feedback_hz);
}

}  // namespace rc10
