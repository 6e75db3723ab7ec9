#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "module/module_type.hpp"

namespace rc10 {

// Keys that chassis with different wheels share.

constexpr OwnKey motorKey(std::string_view name, std::string_view about) {
  return {.name = name, .kind = OwnKey::Kind::kMotor, .required = true, .about = about};
}
constexpr OwnKey lengthKey(std::string_view name, std::string_view about) {
  return {.name = name,
          .kind = OwnKey::Kind::kNumber,
          .unit = "m",
          .max = 10,
          .above_min = true,
          .required = true,
          .about = about};
}
constexpr OwnKey wheelsKey(std::string_view name, std::span<const OwnKey> wheels) {
  return {.name = name,
          .kind = OwnKey::Kind::kSection,
          .required = true,
          .about = "The motor of each wheel, by its place.",
          .keys = wheels};
}

inline constexpr OwnKey kWheelRadiusKey = lengthKey("wheel_radius_m", "Radius of the wheels.");
inline constexpr OwnKey kTrackKey =
    lengthKey("track_m", "From the middle of the left wheels to that of the right ones.");
inline constexpr OwnKey kWheelbaseKey =
    lengthKey("wheelbase_m", "From the axles in front to those at the rear.");
inline constexpr OwnKey kWheelLimitKey{.name = "wheel_limit_rpm",
                                       .kind = OwnKey::Kind::kNumber,
                                       .unit = "rpm",
                                       .max = 100'000,
                                       .above_min = true,
                                       .about =
                                           "Bound of the velocity of each wheel; all slow down together. "
                                           "Default: the lowest limit of its motors."};

inline constexpr std::array kCornerKeys{
    motorKey("front_left", "Its motor."), motorKey("front_right", "Its motor."),
    motorKey("rear_left", "Its motor."), motorKey("rear_right", "Its motor.")};

/// The keys of one type, then those of every chassis.
[[nodiscard]] std::vector<OwnKey> withCommonKeys(std::initializer_list<OwnKey> own);

/// The motors in the section `key` of `own`, in the order of `names`; each may be there once, and takes
/// targets of this mode.
[[nodiscard]] Result<std::vector<std::size_t>> motorsOf(const OwnValues& own, std::string_view key,
                                                        std::span<const OwnKey> names, ControlMode mode,
                                                        const RobotOutline& robot);

/// An error if power_limit_w could not act: the torque of one of the motors is not known.
[[nodiscard]] Result<void> checkPowerLimit(const OwnValues& own, const std::vector<std::size_t>& motors,
                                           const RobotOutline& robot);

/// wheel_limit_rpm, or what the slowest of the motors can be told.
[[nodiscard]] Result<double> wheelLimit(const OwnValues& own, const std::vector<std::size_t>& motors,
                                        const RobotOutline& robot);

}  // namespace rc10
