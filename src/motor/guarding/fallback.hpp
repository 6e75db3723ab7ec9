#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "app/time.hpp"
#include "motor/drive_frames.hpp"

namespace rc10 {

/// Action of a motor whose target has ended.
enum class FallbackAction : std::uint8_t { kCoast, kDamp, kBrake, kHold, kRamp };

/// As the configuration writes them, in the order of FallbackAction.
inline constexpr std::array<std::string_view, 5> kFallbackWords{"coast", "damp", "brake", "hold", "ramp"};

struct FallbackConfig {
  FallbackAction on_timeout = FallbackAction::kCoast;  ///< The last command has lapsed.
  FallbackAction on_disable = FallbackAction::kCoast;  ///< Until it stands still; also when rc10d ends.
  FallbackAction on_estop = FallbackAction::kCoast;    ///< Also when its group stops.
  Duration hold_max = std::chrono::seconds{10};        ///< A hold ends after this.
  Duration brake_max = std::chrono::seconds{10};       ///< A brake in an e-stop ends after this.
  Duration ramp = std::chrono::seconds{1};  ///< A ramp is at rest after this, and then without torque.
};

[[nodiscard]] constexpr FrameKind frameKindOf(FallbackAction action) noexcept {
  switch (action) {
    case FallbackAction::kCoast: break;
    case FallbackAction::kDamp: return FrameKind::kDamp;
    case FallbackAction::kBrake: return FrameKind::kBrake;
    case FallbackAction::kHold: return FrameKind::kHold;
    case FallbackAction::kRamp: return FrameKind::kCommand;  // a velocity
  }
  return FrameKind::kRest;
}

/// End of a hold or a brake that must not push for ever.
struct FallbackBound {
  std::optional<Duration> most;       ///< None: it acts until its end.
  FrameKind then = FrameKind::kDamp;  ///< Never rest: a load must not fall after a while.
  bool estop = false;                 ///< It replaces what held a load, perhaps.
};

/// Kind of frame in place of a hold, a brake or a ramp that a load drags along; kRest: the drive has none
/// that only resists.
[[nodiscard]] constexpr FrameKind resistanceOf(const DriveFrames& frames) noexcept {
  if (frames.damp != Provision::kUnsupported) return FrameKind::kDamp;
  return resists(FrameKind::kBrake, frames) ? FrameKind::kBrake : FrameKind::kRest;
}

/// `estop`: of the robot. In one, motors have no torque of their own in the end (IEC 60204-1); a group that
/// stops keeps its brakes, or a robot would roll down its slope.
[[nodiscard]] constexpr FallbackBound boundOf(FallbackAction action, bool estop, const FallbackConfig& config,
                                              const DriveFrames& frames) noexcept {
  FallbackBound bound;
  bound.estop = estop;
  if (action == FallbackAction::kHold) bound.most = config.hold_max;
  if (action == FallbackAction::kBrake && estop) bound.most = config.brake_max;
  if (frames.damp != Provision::kUnsupported) return bound;
  bound.then = frames.brake != Provision::kUnsupported ? FrameKind::kBrake : FrameKind::kHold;
  return bound;
}

/// The fallback that is in force for one motor, if any. Scheduler thread only.
class Fallback {
 public:
  /// Time for which it acts.
  enum class Until : std::uint8_t { kEnded, kStandstill };

  /// Way to rest of FallbackAction::kRamp: SS1 of IEC 61800-5-2 by time.
  struct Ramp {
    double from_rpm = 0.0;
    Duration over{};
  };

  void begin(FallbackAction action, Until until, const FallbackBound& bound, const Ramp& ramp,
             MonotonicTime now) noexcept {
    kind_ = frameKindOf(action);
    ramp_ = ramp;
    begun_ = now;
    until_ = until;
    bounded_ = bound.most.has_value();
    bound_ = now + bound.most.value_or(Duration{});
    then_ = bound.then;
    estop_ = bound.estop;
    ends_ = kind_ == FrameKind::kCommand ? now + ramp.over + kRampRest : MonotonicTime::max();
    moved_ = now;
    still_deg_ = std::numeric_limits<double>::quiet_NaN();
  }
  void end() noexcept { kind_ = FrameKind::kRest; }
  /// The speed of a ramp that had no measured one when it began; its time runs on.
  void rampFrom(double rpm) noexcept { ramp_.from_rpm = rpm; }
  /// This kind acts in its place from now on, and ends as it would have.
  void giveWay(FrameKind kind) noexcept { kind_ = then_ = kind; }
  [[nodiscard]] bool acts() const noexcept { return kind_ != FrameKind::kRest; }
  [[nodiscard]] MonotonicTime begun() const noexcept { return begun_; }
  /// It damps, brakes or holds, and has for at least `time`; a ramp does not count, nor what acts in its
  /// place: it ends.
  [[nodiscard]] bool resistsFor(Duration time, MonotonicTime now) const noexcept {
    return acts() && ends_ == MonotonicTime::max() && now - begun_ >= time;
  }
  /// Its motor is disabled though nobody asked for it: a load must not fall, so it acts on. What damps, or
  /// ends in damp, ends at standstill.
  void disabled() noexcept {
    if (bounded_ || (kind_ == FrameKind::kDamp && !estop_)) until_ = Until::kStandstill;
  }
  /// A hold that ends with its time or at standstill, as after a disable.
  [[nodiscard]] bool holdsAfterDisable() const noexcept {
    return kind_ == FrameKind::kHold && until_ == Until::kStandstill;
  }
  /// Kind of frame for the drive; kRest while no fallback is in force.
  [[nodiscard]] FrameKind kind() const noexcept { return kind_; }

  /// The velocity of a ramp: in proportion to the time that it has left.
  [[nodiscard]] double rampRpm(MonotonicTime now) const noexcept {
    const Duration left = begun_ + ramp_.over - now;
    return left <= Duration{0} ? 0.0
                               : ramp_.from_rpm * static_cast<double>(seconds(left) / seconds(ramp_.over));
  }

  /// Last sample of its motor.
  struct Seen {
    bool stands_still = false;
    double angle_deg = 0.0;    ///< Turns counted.
    MonotonicTime received{};  ///< Nothing is known of the time since.
  };
  /// Once per tick while it acts.
  void step(const Seen& seen, MonotonicTime now) noexcept {
    if (acts() && now >= ends_) end();
    const bool becomes = acts() && bounded_ && now >= bound_ && kind_ != then_;
    if (becomes) kind_ = then_;
    if (std::isnan(still_deg_)) still_deg_ = seen.angle_deg;
    // A load that was held begins to move only now, and may sink more slowly than what counts as standstill.
    if (!seen.stands_still || becomes || std::fabs(seen.angle_deg - still_deg_) > kStrayDeg) {
      moved_ = now;
      still_deg_ = seen.angle_deg;
    }
    // A hold is for a load that would move by itself: that it stands still proves nothing, nor does it under
    // the brake of a drive that cannot damp.
    const bool proves = kind_ == FrameKind::kDamp || !bounded_;
    if (until_ == Until::kStandstill && proves && seen.received - moved_ >= kSettled) end();
  }

 private:
  // Standstill after which it is not on its way back from an overshoot: to the last sample, for in a pause or
  // a silence a load may sink.
  static constexpr Duration kSettled = std::chrono::milliseconds{300};

  // Way within kSettled that is none: noise of an encoder, and its steps.
  static constexpr double kStrayDeg = 0.5;

  // A motor that lags behind its ramp has this time to come to rest.
  static constexpr Duration kRampRest = std::chrono::milliseconds{200};

  FrameKind kind_ = FrameKind::kRest;
  Ramp ramp_;
  MonotonicTime begun_{};
  Until until_ = Until::kEnded;
  bool bounded_ = false;
  bool estop_ = false;
  MonotonicTime bound_{};
  MonotonicTime ends_ = MonotonicTime::max();  ///< End of a ramp.
  FrameKind then_ = FrameKind::kDamp;
  MonotonicTime moved_{};
  double still_deg_ = 0.0;  ///< Angle at moved_; NaN: not seen yet.
};

}  // namespace rc10
