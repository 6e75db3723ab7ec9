#pragma once

#include <chrono>

#include "app/time.hpp"

namespace rc10::sim {

/// A hand that takes a shaft, turns it and lets go. Of the drive's own shaft, as MotorLoad is.
struct Hand {
  double by_deg = 0.0;     ///< From where the shaft is when it is taken.
  double speed_rpm = 0.0;  ///< On the way; above 0.
  double torque_nm = 0.0;  ///< It pulls no harder, and a motor that holds may win; above 0.
  Duration hold{};         ///< It stays there so long, beside kSettle, before it lets go.

  /// It brings the shaft to rest at its end.
  static constexpr Duration kSettle{std::chrono::milliseconds{300}};
};

}  // namespace rc10::sim
