#include "module/joint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "app/s_curve_profile.hpp"
#include "app/target.hpp"
#include "app/trapezoid_profile.hpp"
#include "app/units.hpp"
#include "app/watched_time.hpp"
#include "module/held_back.hpp"
#include "module/joint_homing.hpp"
#include "module/joint_homing_check.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

// Above the way of a shaft in the tick after it was zeroed, and far below the error of a wrong reference.
constexpr double kZeroedWithinDeg = 10.0;
// Share of max_velocity_deg_s: a shaft that turns slower rests.
constexpr double kRestShare = 0.02;
// Lead of the reference where max_lead_deg is 0: the way of this time at max_velocity_deg_s; and so many
// tolerances, where an encoder is coarse.
constexpr double kLeadSeconds = 0.1;
constexpr double kLeadTolerances = 10.0;
// A motor that is waited for comes nearer by a tolerance within this time, or is blocked.
constexpr double kBlockedSeconds = 0.2;
// A target beyond the limits is reported again after this time without one.
constexpr Duration kBeyondAgain = std::chrono::seconds{1};
constexpr std::array<std::string_view, 3> kHomings{"none", "stop", "switch"};
constexpr std::array<std::string_view, 2> kOnSilence{"hold", "let_go"};

constexpr std::array kJointKeys{
    OwnKey{.name = "motor",
           .kind = kMotor,
           .required = true,
           .about = "The motor; it needs total_angle targets, and current targets if it homes. Its soft "
                    "limits (angle_min_deg, angle_max_deg) bound the moves."},
    OwnKey{.name = "max_velocity_deg_s",
           .kind = kNumber,
           .unit = "deg/s",
           .max = 1e6,
           .above_min = true,
           .required = true,
           .about = "Highest velocity of a move."},
    OwnKey{.name = "max_acceleration_deg_s2",
           .kind = kNumber,
           .unit = "deg/s^2",
           .max = 1e7,
           .above_min = true,
           .required = true,
           .about = "Highest acceleration and deceleration of a move."},
    OwnKey{.name = "max_jerk_deg_s3",
           .kind = kNumber,
           .unit = "deg/s^3",
           .max = 1e9,
           .default_text = "0",
           .about = "How fast the acceleration may change: the move becomes an S-curve. 0: not limited."},
    OwnKey{.name = "max_lead_deg",
           .kind = kNumber,
           .unit = "deg",
           .max = 3600,
           .default_text = "0",
           .about =
               "Most that the reference runs ahead of the motor: it waits for one that is held, blocked or "
               "slowed. 0: the way of 0.1 s at max_velocity_deg_s, and at least 10 times tolerance_deg."},
    OwnKey{.name = "tolerance_deg",
           .kind = kNumber,
           .unit = "deg",
           .max = 360,
           .above_min = true,
           .default_text = "1",
           .about = "A move is done when the motor stands this close to its target."},
    OwnKey{.name = "settle_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 1,
           .max = 60'000,
           .default_text = "1000",
           .about =
               "A move that is not done within this time after the end of its profile has failed, and so has "
               "one whose reference has waited that long for the motor."},
    OwnKey{.name = "homing",
           .kind = kChoice,
           .choices = kHomings,
           .default_text = "none",
           .about = "How it finds its reference when the input `home` rises: against a stop, or at a switch. "
                    "none: the motor has one."},
    OwnKey{.name = "home_angle_deg",
           .kind = kNumber,
           .unit = "deg",
           .min = -1e6,
           .max = 1e6,
           .default_text = "0",
           .about = "The angle of the stop or of the switch."},
    OwnKey{.name = "homing_velocity_rpm",
           .kind = kNumber,
           .unit = "rpm",
           .min = -10'000,
           .max = 10'000,
           .default_text = "-5",
           .about = "Velocity towards the stop or switch; its sign says where that is."},
    OwnKey{.name = "homing_current_a",
           .kind = kNumber,
           .unit = "A",
           .max = 1000,
           .above_min = true,
           .default_text = "1",
           .about = "Highest current while it homes; it goes to 0 near the homing velocity."},
    OwnKey{.name = "homing_away_deg",
           .kind = kNumber,
           .unit = "deg",
           .max = 3600,
           .above_min = true,
           .default_text = "5",
           .about =
               "Distance that it moves away from the end: first, which shows that it moves at all, and again "
               "between the two meetings with the end; more than homing_tolerance_deg."},
    OwnKey{.name = "homing_tolerance_deg",
           .kind = kNumber,
           .unit = "deg",
           .max = 90,
           .above_min = true,
           .default_text = "1",
           .about =
               "The end is met twice, the second time at half the velocity. Places farther apart are not "
               "the end, nor is a stop nearer than where it began. A standstill moves no farther."},
    OwnKey{.name = "homing_stopped_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 20,
           .max = 10'000,
           .default_text = "200",
           .about = "Standing still for this time is the stop."},
    OwnKey{.name = "homing_timeout_s",
           .kind = kNumber,
           .unit = "s",
           .max = 600,
           .above_min = true,
           .default_text = "10",
           .about = "A homing that takes longer has failed."},
    OwnKey{.name = "switch",
           .kind = kText,
           .about = "For homing: switch: the output of another module that is 1 while the switch is "
                    "closed, such as limit.closed. While that is NaN, homing fails.",
           .pattern = kSignalPattern,
           .words = kSignalWords},
    OwnKey{.name = "on_silence",
           .kind = kChoice,
           .choices = kOnSilence,
           .default_text = "hold",
           .about =
               "When nobody commands it any more: hold brakes within the limits and holds, as long as some "
               "client of the robot is heard; let_go leaves it to the motor's on_timeout."},
    OwnKey{.name = "silence_max_s",
           .kind = kNumber,
           .unit = "s",
           .max = 86'400,
           .default_text = "60",
           .about = "For on_silence: hold: when no client of the robot at all has been heard for this time, "
                    "it ends holding, and its motor does its on_timeout."}};

ModuleSignals jointSignals() {
  return {
      .inputs = {"angle_deg", "home"},
      .outputs = {"state", "move", "angle_deg", "reference_deg", "homed"},
      .events = {
          {.text = "homed", .expected = true},
          {.text = "homing failed: it did not move away from the end, or did not find it in time; see "
                   "homing_current_a, the sign of homing_velocity_rpm and homing_timeout_s"},
          {.text = "a move failed: it does not reach its target; see what is in its way, the motor's "
                   "limits, max_lead_deg, tolerance_deg and settle_ms"},
          {.text = "a target lies beyond the motor's soft limits: it goes to the limit"},
          {.text = "homing failed: the switch is not heard; see the module that reads it"},
          {.text = "homing failed: it stood still, but not at the end: nearer than where it began, at two "
                   "places, before the switch or without the full current, or there was none within the "
                   "travel; see what is in its way, homing_current_a against gravity and friction, and "
                   "homing_tolerance_deg"},
          {.text = "no client has been heard for silence_max_s: it holds no longer"},
          {.text =
               "homing failed: with this zero part of the motor's travel (angle_min_deg to angle_max_deg) "
               "would lie beyond the positions that its drive can be told, or its count of turns is in "
               "doubt until it is disabled and enabled anew; see docs/safety.md"},
          {.text =
               "homing has not begun, or has ended: its motor is not ACTIVE, or another client commands it; "
               "enable it, and let home fall to 0 and rise again"}}};
}

/// The reference that runs ahead of the motor: with or without limited jerk.
class Reference {
 public:
  explicit Reference(const OwnValues& own)
      : trapezoid_({own.number("max_velocity_deg_s"), own.number("max_acceleration_deg_s2")}) {
    if (own.number("max_jerk_deg_s3") <= 0.0) return;
    s_curve_.emplace(SCurveProfile::Limits{own.number("max_velocity_deg_s"),
                                           own.number("max_acceleration_deg_s2"),
                                           own.number("max_jerk_deg_s3")});
  }

  void start(double deg, double deg_per_s) noexcept {
    const ProfileState from{.position = deg, .velocity = deg_per_s};
    s_curve_ ? s_curve_->start(from) : trapezoid_.start(from);
  }
  void step(double target_deg, float dt_s) noexcept {
    s_curve_ ? s_curve_->step(target_deg, dt_s) : trapezoid_.step(target_deg, dt_s);
  }
  void brake(float dt_s) noexcept { s_curve_ ? s_curve_->brake(dt_s) : trapezoid_.brake(dt_s); }
  [[nodiscard]] const ProfileState& state() const noexcept {
    return s_curve_ ? s_curve_->state() : trapezoid_.state();
  }
  [[nodiscard]] bool restsAt(double target_deg) const noexcept {
    return s_curve_ ? s_curve_->restsAt(target_deg) : trapezoid_.restsAt(target_deg);
  }

 private:
  TrapezoidProfile trapezoid_;
  std::optional<SCurveProfile> s_curve_;
};

JointHoming::Config homingConfig(const OwnValues& own, const RobotOutline::Motor& motor) {
  const double far_deg = own.number("homing_velocity_rpm") < 0.0 ? motor.angle_max_deg : motor.angle_min_deg;
  return {.way = own.text("homing") == "switch" ? JointHoming::Way::kSwitch : JointHoming::Way::kStop,
          .velocity_rpm = own.number("homing_velocity_rpm"),
          .current_a = own.number("homing_current_a"),
          .away_deg = own.number("homing_away_deg"),
          .tolerance_deg = own.number("homing_tolerance_deg"),
          .travel_deg = std::fabs(far_deg - own.number("home_angle_deg")),
          .stopped = std::chrono::milliseconds{own.integer("homing_stopped_ms")},
          .timeout = std::chrono::milliseconds{static_cast<int>(own.number("homing_timeout_s") * 1000.0)}};
}

double leadOf(const OwnValues& own) noexcept {
  const double given_deg = own.number("max_lead_deg");
  if (given_deg > 0.0) return given_deg;
  return std::max(kLeadSeconds * own.number("max_velocity_deg_s"),
                  kLeadTolerances * own.number("tolerance_deg"));
}

class Joint : public Module_Base {
 public:
  Joint(const OwnValues& own, const RobotOutline::Motor& motor)
      : Module_Base(jointSignals()),
        motor_(own.motor("motor")),
        min_deg_(std::max(motor.angle_min_deg, -kFarthestAngleDeg)),
        max_deg_(std::min(motor.angle_max_deg, kFarthestAngleDeg)),
        rest_deg_s_(kRestShare * own.number("max_velocity_deg_s")),
        lead_deg_(leadOf(own)),
        tolerance_deg_(own.number("tolerance_deg")),
        settle_s_(static_cast<double>(own.integer("settle_ms")) * 1e-3),
        blocked_s_(std::max(settle_s_, kBlockedSeconds)),
        homes_(own.text("homing") != "none"),
        home_angle_deg_(own.number("home_angle_deg")),
        holds_(own.text("on_silence") == "hold"),
        silence_max_s_(own.number("silence_max_s")),
        switch_name_(own.text("switch")),
        reference_(own),
        homing_(homingConfig(own, motor)) {}

  [[nodiscard]] Result<void> connect(const ModuleDirectory& others) override {
    if (switch_name_.empty()) return {};
    auto place = others.findOutput(switch_name_);
    if (!place) return fail("switch: " + place.error().message);
    switch_ = *place;
    return {};
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const auto& feedback = robot.feedback(motor_);
    const bool home_asked = homes_ && homeRises(tick, robot);
    if (!robot.obeys(motor_)) {
      if (home_asked || state_ == State::kHoming) robot.report(kCannotHome);
      idle();
    } else {
      if (home_asked) beginHoming(feedback, tick, robot);
      if (state_ == State::kHoming) {
        stepHoming(feedback, tick, robot);
      } else {
        follow(feedback, tick, robot);
      }
    }
    setOutput(kState, static_cast<double>(state_));
    setOutput(kMove, static_cast<double>(move_));
    setOutput(kMeasured, feedback.total_angle_deg);
    setOutput(kReference, state_ == State::kFollowing ? reference_.state().position : kNoSignal);
    setOutput(kHomed, feedback.zeroed ? 1.0 : 0.0);
  }

 private:
  enum Input : std::size_t { kAngleDeg, kHome };
  enum Output : std::size_t { kState, kMove, kMeasured, kReference, kHomed };
  enum EventPlace : std::size_t {
    kIsHomed,
    kNotHomed,
    kNotReached,
    kBeyond,
    kNoSwitch,
    kNoStop,
    kSilent,
    kNoReach,
    kCannotHome
  };

  enum class State { kIdle, kHoming, kFollowing, kHomingFailed };
  enum class Move { kNone, kUnderWay, kDone, kFailed };

  [[nodiscard]] JointHoming::Measured measured(const MotorFeedback& feedback, const Tick& tick,
                                               const ModuleRobot& robot) const noexcept {
    const double closed = switch_ ? robot.read(*switch_) : 0.0;
    return {.total_angle_deg = feedback.total_angle_deg,
            .velocity_rpm = static_cast<double>(feedback.velocity_rpm),
            .current_a = static_cast<double>(feedback.current_a),
            .speed_ceiling_rpm = robot.speedCeilingRpm(motor_),
            .at_switch = closed >= 0.5,
            .switch_heard = std::isfinite(closed),
            .received = feedback.received,
            .now = tick.now};
  }

  void idle() noexcept {
    state_ = State::kIdle;
    move_ = Move::kNone;
  }

  /// A message asks for it and the last one of the same client did not. Neither a gap in the stream of a
  /// client is a fall nor what another said meanwhile: it would home anew after each.
  [[nodiscard]] bool homeRises(const Tick& tick, ModuleRobot& robot) noexcept {
    if (!commanded()) {
      unheard_.step(tick);
      if (unheard_.seconds() >= HeldBack::kLetGoSeconds) home_is_high_ = false;
      return false;
    }
    const bool lately = unheard_.seconds() < HeldBack::kLetGoSeconds;
    const bool taken_over = std::exchange(counted_for_, senderCount()) != senderCount() && lately;
    unheard_.restart();
    const bool was_high = std::exchange(home_is_high_, input(kHome) >= 0.5);
    if (taken_over && (home_is_high_ || state_ == State::kHoming)) {
      robot.report(kCannotHome);
      if (state_ == State::kHoming) idle();
    }
    return home_is_high_ && !was_high && !taken_over;
  }

  // The reference of its angle is in doubt, and a stop may lie beyond the limits that follow from it.
  void beginHoming(const MotorFeedback& feedback, const Tick& tick, ModuleRobot& robot) noexcept {
    const auto now = measured(feedback, tick, robot);
    if (!now.switch_heard || feedback.zero_refused) {
      // A homing in vain would give up the angle, with the load that is held there, and the soft limits.
      robot.report(now.switch_heard ? kNoReach : kNoSwitch);
      if (!feedback.zeroed) state_ = State::kHomingFailed;
      return;
    }
    robot.forgetReference(motor_);
    homing_.start(now);
    state_ = State::kHoming;
    move_ = Move::kNone;
    zero_asked_ = false;
  }

  void stepHoming(const MotorFeedback& feedback, const Tick& tick, ModuleRobot& robot) noexcept {
    // The client that asked has to stay. When it is heard again, homing begins anew. (Another: homeRises().)
    if (!commanded()) {
      home_is_high_ = false;
      return idle();
    }
    if (zero_asked_) {
      // The zero of the tick before is in force, unless the motor refused it.
      if (!feedback.zeroed || std::fabs(feedback.total_angle_deg - home_angle_deg_) > kZeroedWithinDeg)
        return failHoming(kNoReach, robot);
      robot.report(kIsHomed);
      beginFollowing(feedback);
      follow(feedback, tick, robot);
      return;
    }
    const auto now = measured(feedback, tick, robot);
    switch (homing_.step(now)) {
      case JointHoming::Progress::kUnderWay: break;
      case JointHoming::Progress::kFound:
        robot.ask(RobotRequest::kZero, motor_, home_angle_deg_);
        zero_asked_ = true;
        break;
      case JointHoming::Progress::kFailed: return failHoming(now.switch_heard ? kNotHomed : kNoSwitch, robot);
      case JointHoming::Progress::kNoStop: return failHoming(kNoStop, robot);
    }
    robot.setTarget(motor_, {.mode = ControlMode::kCurrent, .value = homing_.current()});
  }

  void failHoming(EventPlace why, ModuleRobot& robot) noexcept {
    robot.report(why);
    state_ = State::kHomingFailed;
  }

  // The profile begins with the motion of the shaft: one that turns is slowed down, not stopped in a jump.
  void beginFollowing(const MotorFeedback& feedback) noexcept {
    const double here_deg = feedback.total_angle_deg;
    const double deg_s = static_cast<double>(feedback.velocity_rpm) * kDegPerSPerRpm;
    const bool turns = std::fabs(deg_s) > rest_deg_s_ && here_deg >= min_deg_ && here_deg <= max_deg_;
    reference_.start(here_deg, turns ? deg_s : 0.0);
    target_deg_ = here_deg;
    state_ = State::kFollowing;
    move_ = Move::kNone;
  }

  void follow(const MotorFeedback& feedback, const Tick& tick, ModuleRobot& robot) noexcept {
    const bool wanted = commanded() && std::isfinite(input(kAngleDeg));
    if (!feedback.zeroed || state_ == State::kHomingFailed) {
      if (state_ == State::kFollowing) idle();
      return;
    }
    if (state_ != State::kFollowing) {
      if (!wanted) return;
      beginFollowing(feedback);
    }
    if (wanted) {
      aim(robot, tick);
      lead(feedback, tick);
    } else if (holds_ && robot.clientsSilentSeconds() < silence_max_s_) {
      reference_.brake(tick.dt_s);
    } else {
      if (holds_) robot.report(kSilent);
      return idle();
    }
    judge(feedback, tick, robot, wanted);
    const auto& reference = reference_.state();
    robot.setTarget(motor_, {.mode = ControlMode::kTotalAngle,
                             .value = reference.position,
                             .velocity_ff_rpm = static_cast<float>(reference.velocity / kDegPerSPerRpm)});
  }

  void aim(ModuleRobot& robot, const Tick& tick) noexcept {
    const double asked_deg = input(kAngleDeg);
    const double target_deg = std::clamp(asked_deg, min_deg_, max_deg_);
    if (target_deg != asked_deg) {
      if (!beyond_ || tick.now - *beyond_ >= kBeyondAgain) robot.report(kBeyond);
      beyond_ = tick.now;
    }
    if (target_deg == target_deg_ && move_ != Move::kNone) return;
    target_deg_ = target_deg;
    move_ = Move::kUnderWay;
    arrived_.restart();
    closest_deg_ = std::numeric_limits<double>::infinity();
    waited_s_ = 0.0;
  }

  // A reference that went on while the motor is blocked would make it leap all of that way, once it is
  // free.
  void lead(const MotorFeedback& feedback, const Tick& tick) noexcept {
    const auto& reference = reference_.state();
    const double here_deg = feedback.total_angle_deg;
    const double sign = std::copysign(1.0, target_deg_ - reference.position);
    const double ahead_deg = sign * (reference.position - here_deg);
    const bool waits = ahead_deg > lead_deg_ && !reference_.restsAt(target_deg_);
    waited_ = waits || (waited_ && ahead_deg > lead_deg_ / 2);
    // A blocked shaft may shake: one that is nearer to its target than ever since has advanced.
    const double away_deg = std::fabs(target_deg_ - here_deg);
    if (away_deg < closest_deg_ - tolerance_deg_) {
      closest_deg_ = away_deg;
      waited_s_ = 0.0;
    } else if (waited_) {
      waited_s_ += static_cast<double>(tick.dt_s);
    }
    if (waits) {
      const double deg_s = sign * static_cast<double>(feedback.velocity_rpm) * kDegPerSPerRpm;
      reference_.start(here_deg + sign * lead_deg_,
                       sign * std::clamp(deg_s, 0.0, std::max(sign * reference.velocity, 0.0)));
    } else {
      reference_.step(target_deg_, tick.dt_s);
    }
  }

  void judge(const MotorFeedback& feedback, const Tick& tick, ModuleRobot& robot, bool wanted) noexcept {
    arrived_.step(tick);
    if (move_ != Move::kUnderWay || !wanted) return;
    const bool rests = reference_.restsAt(target_deg_);
    const double away_deg = std::fabs(feedback.total_angle_deg - target_deg_);
    // A motor that still comes nearer is slow, and has not failed.
    if (!rests || away_deg < nearest_deg_ - tolerance_deg_) {
      arrived_.restart();
      nearest_deg_ = away_deg;
    }
    if (rests && away_deg <= tolerance_deg_) {
      move_ = Move::kDone;
    } else if (arrived_.seconds() >= settle_s_ || waited_s_ >= blocked_s_) {
      move_ = Move::kFailed;
      robot.report(kNotReached);
    }
  }

  std::size_t motor_;
  double min_deg_;
  double max_deg_;
  double rest_deg_s_;
  double lead_deg_;
  double tolerance_deg_;
  double settle_s_;
  double blocked_s_;
  bool homes_;
  double home_angle_deg_;
  bool holds_;
  double silence_max_s_;
  std::string switch_name_;
  std::optional<SignalPlace> switch_;
  Reference reference_;
  JointHoming homing_;

  State state_ = State::kIdle;
  Move move_ = Move::kNone;
  bool home_is_high_ = false;
  std::uint32_t counted_for_ = 0;               ///< senderCount() of home_is_high_.
  WatchedTime unheard_ = WatchedTime::never();  ///< Since somebody commanded it.
  bool zero_asked_ = false;
  double target_deg_ = 0.0;
  std::optional<MonotonicTime> beyond_;  ///< Last target that was out of reach.
  WatchedTime arrived_;                  ///< Since the reference came to rest at the target, or the
  double nearest_deg_ = 0.0;             ///< motor nearer to it than so.
  bool waited_ = false;                  ///< The reference waits, or has not gone on far since.
  double waited_s_ = 0.0;     ///< Time of waiting while the motor came no nearer than closest_deg_.
  double closest_deg_ = 0.0;  ///< Least distance from the target when it last advanced.
};

class JointType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "joint"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "One axis that homes and moves between positions.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kJointKeys; }
  [[nodiscard]] bool homes(const ModuleSettings& settings, std::size_t motor) const override {
    return settings.own.motor("motor") == motor && settings.own.text("homing") != "none";
  }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    const auto motor = own.motor("motor");
    if (auto able = robot.require(ControlMode::kTotalAngle, motor, "motor"); !able)
      return tl::unexpected(able.error());
    const auto homing = own.text("homing");
    if (homing != "none") {
      if (auto able = robot.require(ControlMode::kCurrent, motor, "homing"); !able)
        return tl::unexpected(able.error());
      if (auto makes_sense = checkHoming(own, robot.motors[motor]); !makes_sense)
        return tl::unexpected(makes_sense.error());
    }
    if ((homing == "switch") != own.given("switch"))
      return fail(homing == "switch"
                      ? "switch: is missing; name the output that is 1 while the switch is closed"
                      : "switch: means nothing without homing: switch; remove it or change homing");
    return std::make_unique<Joint>(own, robot.motors[motor]);
  }
};

}  // namespace

const ModuleType& jointType() noexcept {
  static const JointType kType;
  return kType;
}

}  // namespace rc10
