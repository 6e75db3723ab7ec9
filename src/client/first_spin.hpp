#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "app/time.hpp"
#include "link/link_protocol.hpp"

namespace rc10::client {

/// Check of a drive by the motor's response to its first current, a small positive one.
class FirstSpin {
 public:
  enum class Outcome : unsigned char {
    kRight,       ///< It turned the way of the current.
    kWrongWay,    ///< The drive's current has the other sign than its encoder.
    kNotMoved,    ///< By no more than noise, play in the gear, or a shaft that was let go.
    kAtLimit,     ///< The same, and a soft limit of its angle acts.
    kTurnedSoon,  ///< Too fast before the current could have done it.
    kDisagree,    ///< Its speed has one sign, its angle the other.
    kUnknown,     ///< No speed, or no angle.
    kAngleLost,   ///< Its turns were not counted for a while: it may have turned either way.
    kLate,        ///< Somebody was held up: the current was not there, or the speed not known, all the time.
  };
  /// The current acts this long.
  static constexpr Duration kTime = std::chrono::seconds{1};
  /// No state may be older, nor two turns of the program further apart: its targets are valid for this long.
  static constexpr Duration kOldestState = std::chrono::milliseconds{100};
  /// Two states within kOldestState, that a busy computer may miss one.
  static constexpr int kLeastStateHz = 20;

  explicit FirstSpin(double over_speed_rpm) noexcept : over_speed_rpm_(over_speed_rpm) {}

  /// In each turn: takes the newest state, of `mono_us`; the first is that in which the current begins.
  /// False: let go of it at once.
  [[nodiscard]] bool goesOn(const link::MotorState& motor, std::int64_t mono_us, MonotonicTime now) noexcept;

  /// rc10d has told of a gap in its feedback that may hide a turn: goesOn() ends it.
  void loseAngle() noexcept { angle_lost_ = true; }

  /// After the last state.
  [[nodiscard]] Outcome outcome() const noexcept;
  [[nodiscard]] double turnedDeg() const noexcept { return turned_deg_; }
  /// At the last state.
  [[nodiscard]] double velocityRpm() const noexcept { return velocity_rpm_; }

 private:
  [[nodiscard]] bool lasted() const noexcept { return ended_ || last_ - begun_ >= kTime - kOldestState; }

  double over_speed_rpm_;
  std::optional<double> start_deg_;
  MonotonicTime begun_{};
  MonotonicTime last_{};
  double turned_deg_ = 0.0;
  double velocity_rpm_ = 0.0;
  bool fast_ = false;
  bool at_limit_ = false;
  bool turned_soon_ = false;
  bool angle_lost_ = false;
  bool late_ = false;
  bool ended_ = false;
};

/// A gap in the motor's feedback while it was turned, by hand or by current, and the remedy.
[[nodiscard]] std::string angleLost(const std::string& motor);
/// Reason why states of this rate are too rare to end a spin in time, and the remedy; empty: they are not.
[[nodiscard]] std::string whyTooRare(std::int32_t state_hz);
/// Result and remedy in words.
[[nodiscard]] std::string text(const FirstSpin& spin, const std::string& motor);

}  // namespace rc10::client
