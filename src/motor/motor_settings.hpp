#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "motor/cascade.hpp"
#include "motor/first_angle.hpp"

namespace rc10 {

/// The values of the keys that only one family, or one type of module, knows, defaults filled in.
class OwnValues {
 public:
  /// A flag is 0 or 1, a motor its place in the robot's list, a section one of its rows.
  using Value = std::variant<double, std::string, std::vector<OwnValues>>;

  void set(std::string_view key, Value value);
  /// Whether it was written, or has a default.
  [[nodiscard]] bool given(std::string_view key) const { return find(key) != nullptr; }
  /// 0 if there is no such key: a family asks only for keys that it has declared.
  [[nodiscard]] double number(std::string_view key) const;
  [[nodiscard]] int integer(std::string_view key) const { return static_cast<int>(number(key)); }
  [[nodiscard]] bool flag(std::string_view key) const { return number(key) != 0.0; }
  [[nodiscard]] std::string text(std::string_view key) const;
  /// The place of a motor.
  [[nodiscard]] std::size_t motor(std::string_view key) const {
    return static_cast<std::size_t>(number(key));
  }
  /// The maps of a list; one for a section; none if it was not written.
  [[nodiscard]] const std::vector<OwnValues>& rows(std::string_view key) const;
  /// Empty if it was not written.
  [[nodiscard]] const OwnValues& section(std::string_view key) const;

 private:
  [[nodiscard]] const Value* find(std::string_view key) const;

  std::vector<std::pair<std::string, Value>> values_;
};

/// One motor as configured, for its family to build. At the output shaft.
struct MotorSettings {
  std::string name;
  std::string model;
  int id = 0;                       ///< As set on the drive.
  double gear_ratio = 0.0;          ///< Rotor turns per turn of the output shaft; 0: the model's own.
  int direction = 1;                ///< -1: mounted the other way round.
  float effort_limit = 0.0F;        ///< A or V, see MotorTraits::effort; 0: the model's full scale.
  float velocity_limit_rpm = 0.0F;  ///< Bounds every velocity target. 0: none.
  double zero_deg = 0.0;            ///< Output angle of an absolute encoder that is to read 0.
  bool zero_at_power_on = false;    ///< The position of the first sample is 0.
  Travel travel{};                  ///< Tells the turn of an absolute encoder at power-up.
  CascadeConfig loops;              ///< Loops of the host; meaningless where MotorTraits has none.
  int feedback_hz = 0;              ///< As set on the drive, or as often as it is asked.
  int tick_hz = 1000;               ///< Tick rate of the scheduler.
  int command_divider = 1;          ///< It is told something in every n-th tick.
  int command_phase = 0;            ///< In which of those ticks: 0 to n - 1.
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

}  // namespace rc10
