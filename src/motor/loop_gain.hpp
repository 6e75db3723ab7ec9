#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "motor/cascade.hpp"

namespace rc10 {

/// One number of a motor's loops that may change while it runs. The numbers are part of the LCM contract
/// (event 110) and never change.
enum class LoopGain : std::uint8_t {
  kVelocityKp = 0,
  kVelocityKi = 1,
  kVelocityKd = 2,
  kVelocityDeadband = 3,
  kVelocityDerivativeFilter = 4,
  kVelocityIntegralLimit = 5,
  kVelocityIntegralSeparation = 6,
  kVelocityTargetBandwidth = 7,
  kAngleKp = 8,
  kAngleKi = 9,
  kAngleKd = 10,
  kAngleDeadband = 11,
  kAngleVelocityLimit = 12,
  kAngleIntegralLimit = 13,
  kAngleIntegralSeparation = 14,
  kAngleDerivativeFilter = 15,
};
inline constexpr std::size_t kLoopGainCount = 16;

/// Its place in these loops; null: their velocity loop is of the type without it.
[[nodiscard]] float* gainIn(CascadeConfig& loops, LoopGain gain) noexcept;
[[nodiscard]] float gainOf(const CascadeConfig& loops, LoopGain gain) noexcept;  ///< 0: without it.

struct GainChange {
  LoopGain gain{};
  float value = 0.0F;
};

/// Changes of one request, all applied in one tick.
struct GainChanges {
  std::size_t count = 0;
  std::array<GainChange, kLoopGainCount> values{};
};

}  // namespace rc10
