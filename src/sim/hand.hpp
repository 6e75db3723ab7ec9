#pragma once

#include <chrono>

#include "app/time.hpp"

namespace rc10::sim {

/// A hand that takes a shaft, turns it and lets go. Of the drive's own shaft, as MotorLoad is.
struct Hand {
  double by_deg = 0.0;     ///< From where the shaft is when it is taken.
  double speed_rpm = 0.0;  ///< On the way, from kRamp on; above 0.
  double torque_nm = 0.0;  ///< It pulls no harder, and a motor that holds may win; above 0.
  Duration hold{};         ///< Time there, beside kSettle, before it lets go.

  /// It takes so long to reach its speed, and to come to rest from it; longer where its torque is too small.
  static constexpr Duration kRamp{std::chrono::milliseconds{100}};
  /// It brings the shaft to rest at its end.
  static constexpr Duration kSettle{std::chrono::milliseconds{300}};
};

}  // namespace rc10::sim
