#pragma once

#include <vector>

#include "config/robot_config.hpp"

namespace rc10 {

/// Load of a bus, both directions together, as fractions of its bit rate. The real load lies
/// between the two: it depends on the bits that are sent.
struct BusLoad {
  double unstuffed = 0.0;   ///< Not a single stuff bit.
  double worst_case = 0.0;  ///< As many as there can be.
};

[[nodiscard]] BusLoad operator+(const BusLoad& a, const BusLoad& b) noexcept;

/// More than this in the worst case is worth a warning: frames start to wait for each other.
inline constexpr double kCrowdedLoad = 0.8;

/// The feedback of every motor at its rate, and its commands at theirs; a frame that several motors share is
/// one frame. `rate_hz`: of the scheduler.
[[nodiscard]] BusLoad predictLoad(const BusConfig& bus, int rate_hz);

/// The same for each motor, in their order. A shared command frame counts for the first that uses it.
[[nodiscard]] std::vector<BusLoad> predictLoadByMotor(const BusConfig& bus, int rate_hz);

/// The largest feedback rate of all motors that speak unasked at which the worst case stays within
/// kCrowdedLoad, in whole Hz; 0: the commands alone are too much.
[[nodiscard]] int feedbackRateThatFits(const BusConfig& bus, int rate_hz);

/// The smallest command_divider of all motors with frames of their own at which it does; 0: none.
[[nodiscard]] int dividerThatFits(const BusConfig& bus, int rate_hz);

}  // namespace rc10
