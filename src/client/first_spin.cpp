#include "client/first_spin.hpp"

#include <cmath>

#include "client/quantity_text.hpp"

namespace rc10::client {
namespace {

// Less is noise, play in the gear, or the shaft that was let go.
constexpr double kLeastTurnDeg = 5.0;
/// Bound of the feedback age in a state, as in a test of motion: a drive may speak 10 times a second.
constexpr Duration kOldestFeedback = std::chrono::milliseconds{200};

}  // namespace

bool FirstSpin::goesOn(const link::MotorState& motor, std::int64_t mono_us, MonotonicTime now) noexcept {
  const bool begins = !start_deg_;
  if (begins) begun_ = last_ = now;
  const auto state_age = now - MonotonicTime{std::chrono::microseconds{mono_us}};
  late_ = now - last_ > kOldestState || state_age > kOldestState ||
          std::chrono::microseconds{motor.feedback_age_us} > kOldestFeedback;
  last_ = now;
  // Where it stands when the current begins: a shaft that was let go has turned before.
  if (begins) start_deg_ = motor.total_angle_deg;
  turned_deg_ = motor.total_angle_deg - *start_deg_;
  velocity_rpm_ = static_cast<double>(motor.velocity_rpm);
  // Written so that what is unknown ends it.
  const bool slow = std::abs(velocity_rpm_) <= over_speed_rpm_;
  fast_ = std::abs(velocity_rpm_) > over_speed_rpm_;
  if (begins) turned_soon_ = fast_;
  at_limit_ = (motor.limits & kLimitAngle) != 0;
  ended_ = !(slow && std::isfinite(turned_deg_)) || angle_lost_ || late_;
  return !ended_;
}

FirstSpin::Outcome FirstSpin::outcome() const noexcept {
  if (angle_lost_) return Outcome::kAngleLost;
  if (start_deg_ && (late_ || !lasted())) return Outcome::kLate;
  if (!start_deg_ || !std::isfinite(velocity_rpm_) || !std::isfinite(turned_deg_)) return Outcome::kUnknown;
  if (turned_soon_) return Outcome::kTurnedSoon;
  // Fast enough is enough, however short the way.
  if (fast_ && velocity_rpm_ * turned_deg_ <= 0.0) return Outcome::kDisagree;
  if (!fast_ && std::abs(turned_deg_) < kLeastTurnDeg)
    return at_limit_ ? Outcome::kAtLimit : Outcome::kNotMoved;
  return turned_deg_ > 0.0 ? Outcome::kRight : Outcome::kWrongWay;
}

std::string angleLost(const std::string& motor) {
  return motor +
         "'s feedback had a gap that may hide a turn: nothing can be judged: commission again, and see "
         "docs/troubleshooting.md if it happens again";
}

std::string whyTooRare(std::int32_t state_hz) {
  if (state_hz >= FirstSpin::kLeastStateHz) return {};
  return "the over-speed is seen by rc10d's states, and `lcm: {state_hz: " + std::to_string(state_hz) +
         "}` makes them too rare to end a spin in time: write `state_hz: " +
         std::to_string(FirstSpin::kLeastStateHz) + "` or more into the robot's file, and restart rc10d";
}

std::string text(const FirstSpin& spin, const std::string& motor) {
  const std::string turned = motor + " turned by " + number(spin.turnedDeg(), 1) + " deg";
  const std::string speed = quantity(spin.velocityRpm(), 0, "rpm");
  switch (spin.outcome()) {
    case FirstSpin::Outcome::kRight: return turned + " the right way: it is ready";
    case FirstSpin::Outcome::kWrongWay:
      return turned +
             " with a positive current: the drive's current has the other sign than its encoder: see its "
             "page "
             "in docs/motors";
    case FirstSpin::Outcome::kNotMoved:
      return turned +
             " with a positive current: it did not move: is it blocked, or the current too small (--limit)?";
    case FirstSpin::Outcome::kAtLimit:
      return turned +
             " with a positive current: its soft limits (angle_min_deg, angle_max_deg) hold it: turn it by "
             "hand "
             "into its travel, and commission again";
    case FirstSpin::Outcome::kTurnedSoon:
      return motor + " turned with " + speed +
             " when the current began: let it come to rest, and commission again";
    case FirstSpin::Outcome::kDisagree:
      return turned + " while its drive told " + speed +
             ": one of them has the wrong sign: see its page in docs/motors";
    case FirstSpin::Outcome::kAngleLost: return angleLost(motor);
    case FirstSpin::Outcome::kLate:
      return motor +
             "'s speed was not known in time, or its current not there all the time: rc10ctl, rc10d or the "
             "drive was held up: nothing can be judged: commission again";
    case FirstSpin::Outcome::kUnknown: break;
  }
  return motor + "'s drive reports no speed or no angle: nothing can be judged";
}

}  // namespace rc10::client
