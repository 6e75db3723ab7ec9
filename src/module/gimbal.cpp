#include "module/gimbal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "app/angle.hpp"
#include "app/limits.hpp"
#include "app/motion_match.hpp"
#include "app/units.hpp"
#include "app/watched_time.hpp"
#include "module/carried_rate.hpp"
#include "module/gimbal_axis.hpp"
#include "module/sensed_angle.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

constexpr OwnKey signalKey(std::string_view name, std::string_view about) {
  return {.name = name, .kind = kText, .about = about, .pattern = kSignalPattern, .words = kSignalWords};
}
constexpr OwnKey reversedKey(std::string_view name, std::string_view about) {
  return {.name = name, .kind = kFlag, .default_text = "false", .about = about};
}
constexpr OwnKey limitKey(std::string_view name, double value_if_not, std::string_view default_text,
                          std::string_view about) {
  return {.name = name,
          .kind = kNumber,
          .unit = "deg",
          .min = -value_if_not,
          .max = value_if_not,
          .default_text = default_text,
          .about = about};
}

constexpr std::array kGimbalKeys{
    OwnKey{.name = "yaw",
           .kind = kMotor,
           .required = true,
           .about = "The motor that turns about the vertical; it needs velocity targets and an absolute "
                    "angle, 0 where "
                    "the gimbal looks to the front of the chassis."},
    OwnKey{.name = "pitch",
           .kind = kMotor,
           .required = true,
           .about = "The motor that lifts; the same, 0 where it looks level, positive where it looks up."},
    signalKey("imu_yaw",
              "The yaw of an inertial sensor on the gimbal, deg. Default: none; it holds to the chassis."),
    signalKey("imu_yaw_rate", "Its rate, deg/s: with it the turning of the chassis is taken off at once."),
    signalKey("imu_pitch",
              "The pitch of that sensor, deg, positive where it looks up. Default: the motor's angle."),
    reversedKey("imu_yaw_reversed",
                "The sensor hangs upside down: its yaw and yaw rate count clockwise, seen from above."),
    reversedKey("imu_pitch_reversed",
                "The sensor's pitch is positive where it looks down: its y axis points to the left."),
    limitKey("pitch_min_deg", 90, "-20", "Lowest pitch that it looks at."),
    limitKey("pitch_max_deg", 90, "30", "Highest pitch that it looks at."),
    OwnKey{.name = "gain_per_s",
           .kind = kNumber,
           .unit = "1/s",
           .max = 100,
           .above_min = true,
           .default_text = "10",
           .about = "Gain of both axes: deg/s for each degree of error."},
    OwnKey{.name = "velocity_limit_rpm",
           .kind = kNumber,
           .unit = "rpm",
           .max = 1000,
           .above_min = true,
           .default_text = "60",
           .about = "Bound of the velocity of each axis."},
    OwnKey{.name = "silence_max_s",
           .kind = kNumber,
           .unit = "s",
           .max = 3600,
           .default_text = "10",
           .about = "Time for which it holds its direction when nobody commands it; then its motors do their "
                    "on_timeout."}};

ModuleSignals gimbalSignals() {
  return {
      .inputs = {"yaw_deg", "pitch_deg", "yaw_rate_deg_s", "pitch_rate_deg_s"},
      .outputs = {"yaw_deg", "pitch_deg", "relative_yaw_deg", "target_yaw_deg", "target_pitch_deg",
                  "stabilised", "imu_lag_ms", "imu_agrees", "turn_after_deg"},
      .events = {{.text = "the inertial sensor is not heard: the gimbal holds to the chassis"},
                 {.text = "the inertial sensor is heard: the gimbal holds to the world", .expected = true},
                 {.text = "nobody has commanded it for silence_max_s: it holds its direction no longer"},
                 {.text = "imu_yaw moves against the yaw motor and is not used: the gimbal holds to the "
                          "chassis; see imu_yaw_reversed, and the motor's direction"},
                 {.text = "imu_yaw_rate moves against the yaw motor and is not used; see imu_yaw_reversed, "
                          "and the motor's direction"},
                 {.text = "imu_pitch moves against the pitch motor and is not used: the motor's angle is; "
                          "see imu_pitch_reversed, and the motor's direction"}}};
}

class Gimbal : public Module_Base {
 public:
  explicit Gimbal(const OwnValues& own)
      : Module_Base(gimbalSignals()),
        yaw_motor_(own.motor("yaw")),
        pitch_motor_(own.motor("pitch")),
        pitch_min_deg_(own.number("pitch_min_deg")),
        pitch_max_deg_(own.number("pitch_max_deg")),
        silence_max_s_(own.number("silence_max_s")),
        names_{own.text("imu_yaw"), own.text("imu_yaw_rate"), own.text("imu_pitch")},
        signs_{signOf(own, "imu_yaw_reversed"), signOf(own, "imu_yaw_reversed"),
               signOf(own, "imu_pitch_reversed")},
        yaw_({own.number("gain_per_s"), own.number("velocity_limit_rpm"), true}),
        pitch_({own.number("gain_per_s"), own.number("velocity_limit_rpm"), false}) {}

  [[nodiscard]] Result<void> connect(const ModuleDirectory& others) override {
    constexpr std::array kNames{"imu_yaw", "imu_yaw_rate", "imu_pitch"};
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i].empty()) continue;
      auto place = others.findOutput(names_[i]);
      if (!place) return fail(std::string{kNames[i]} + ": " + place.error().message);
      places_[i] = *place;
    }
    return {};
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const auto& yaw = robot.feedback(yaw_motor_);
    const auto& pitch = robot.feedback(pitch_motor_);
    compare(tick, robot);
    const double imu_yaw_deg = read(robot, kImuYaw);
    const bool stabilised = std::isfinite(imu_yaw_deg);
    const double yaw_deg = sensed_yaw_.step(imu_yaw_deg, static_cast<double>(yaw.angle_deg));
    const double imu_pitch_deg = read(robot, kImuPitch);
    const bool by_imu_pitch = std::isfinite(imu_pitch_deg);
    const double motor_pitch_deg = wrapHalfTurn(static_cast<double>(pitch.angle_deg));
    const bool ready = robot.obeys(yaw_motor_) && robot.obeys(pitch_motor_) && yaw.zeroed && pitch.zeroed;
    const bool restarts = !ready || !was_ready_;
    // A last word from before a stop, or of an opposed sensor, would lead beyond pitch_min_deg or
    // pitch_max_deg.
    if (restarts || opposed(kImuPitch)) sensed_pitch_.forget();
    const double pitch_deg = sensed_pitch_.step(imu_pitch_deg, motor_pitch_deg);
    // The direction is kept; the chassis may have turned by the time the sensor is back.
    if (restarts || stabilised != was_stabilised_) {
      if (!restarts && !opposed(kImuYaw)) robot.report(stabilised ? kBack : kLost);
    }
    // Until it is commanded it may be turned by hand, or sag: it begins where it looks then.
    const bool idle = restarts || !was_commanded_;
    if (idle || stabilised != was_stabilised_) yaw_.hold(yaw_deg);
    if (idle || by_imu_pitch != was_by_imu_pitch_) pitch_.hold(pitch_deg);
    // Disabling is a person's, who may mount the sensor anew until the next enabling; a takeover or a lost
    // reference turns none.
    const bool active = robot.status(yaw_motor_) == MotorStatus::kActive &&
                        robot.status(pitch_motor_) == MotorStatus::kActive;
    if (was_active_ != active) forgetSensors(active);
    was_active_ = active;
    was_ready_ = ready;
    was_stabilised_ = stabilised;
    was_by_imu_pitch_ = by_imu_pitch;
    if (ready && was_commanded_)
      follow(tick, robot, {yaw_deg, stabilised ? carried_.degPerSecond() : kNoSignal}, pitch_deg);
    holdOn(ready, tick, robot);
    setOutput(kOutYaw, wrapHalfTurn(yaw_deg));
    setOutput(kOutPitch, pitch_deg);
    const bool yaw_known = yaw.zeroed && robot.status(yaw_motor_) != MotorStatus::kOffline;
    const double relative_deg = yaw_known ? wrapHalfTurn(static_cast<double>(yaw.angle_deg)) : kNoSignal;
    setOutput(kRelativeYaw, relative_deg);
    // Only a direction of the world comes nearer when the chassis turns after it.
    setOutput(kOutTurnAfter, stabilised && was_commanded_ ? relative_deg : kNoSignal);
    setOutput(kTargetYaw, wrapHalfTurn(yaw_.target()));
    setOutput(kTargetPitch, pitch_.target());
    setOutput(kStabilised, stabilised ? 1.0 : 0.0);
    setOutput(kImuLagMs, lagMs());
    setOutput(kImuAgrees, agreement());
  }

 private:
  enum Input : std::size_t { kYawDeg, kPitchDeg, kYawRate, kPitchRate };
  enum Output : std::size_t {
    kOutYaw,
    kOutPitch,
    kRelativeYaw,
    kTargetYaw,
    kTargetPitch,
    kStabilised,
    kImuLagMs,
    kImuAgrees,
    kOutTurnAfter
  };
  enum EventPlace : std::size_t { kLost, kBack, kSilent, kFirstOpposed };
  enum ImuSignal : std::size_t { kImuYaw, kImuYawRate, kImuPitch, kImuSignals };

  // A degree within a tenth of a second; less than that where it is faster.
  static constexpr MotionMatch::Config kAngleMatch{.enough = 0.002, .circular_period = kDegPerTurn};

  [[nodiscard]] static double signOf(const OwnValues& own, std::string_view key) {
    return own.flag(key) ? -1.0 : 1.0;
  }

  // A sensor of the wrong sign makes its loop run away: it is found by the first motion, also of a hand, and
  // is not used until the motors are enabled again.
  void compare(const Tick& tick, ModuleRobot& robot) noexcept {
    const auto& yaw = robot.feedback(yaw_motor_);
    yaw_match_.step(yaw.total_angle_deg, raw(robot, kImuYaw), tick.dt_s);
    carried_.step(static_cast<double>(yaw.velocity_rpm), raw(robot, kImuYawRate), tick.dt_s);
    pitch_match_.step(robot.feedback(pitch_motor_).total_angle_deg, raw(robot, kImuPitch), tick.dt_s);
    for (std::size_t i = 0; i < kImuSignals; ++i) {
      if (opposed(i) && !told_opposed_[i]) robot.report(kFirstOpposed + i);
      told_opposed_[i] = opposed(i);
    }
  }
  [[nodiscard]] const MotionMatch& match(std::size_t which) const noexcept {
    if (which == kImuYawRate) return carried_.match();
    return which == kImuYaw ? yaw_match_ : pitch_match_;
  }
  [[nodiscard]] bool opposed(std::size_t which) const noexcept {
    return match(which).sign() == MotionMatch::Sign::kOpposed;
  }
  // A sign that a hand has shown to be wrong stays so when the motors are enabled.
  void forgetSensors(bool but_opposed) noexcept {
    if (!(but_opposed && opposed(kImuYaw))) yaw_match_.reset();
    if (!(but_opposed && opposed(kImuYawRate))) carried_.forget();
    if (!(but_opposed && opposed(kImuPitch))) pitch_match_.reset();
  }
  [[nodiscard]] double lagMs() const noexcept {
    for (const auto which : {kImuYawRate, kImuYaw, kImuPitch}) {
      if (const auto lag_s = match(which).lagSeconds()) return *lag_s * 1000.0;
    }
    return kNoSignal;
  }
  // 0: one does not; NaN: not each of them was seen to move yet.
  [[nodiscard]] double agreement() const noexcept {
    double all = kNoSignal;
    bool unknown = false;
    for (std::size_t i = 0; i < kImuSignals; ++i) {
      if (!places_[i]) continue;
      if (opposed(i)) return 0.0;
      all = 1.0;
      unknown = unknown || match(i).sign() == MotionMatch::Sign::kUnknown;
    }
    return unknown ? kNoSignal : all;
  }

  // After the last command it holds its direction for silence_max_s, since a gimbal that is let go falls. Not
  // for ever: its client may be gone for good.
  void holdOn(bool ready, const Tick& tick, ModuleRobot& robot) noexcept {
    silent_.step(tick);
    if (commanded()) silent_.restart();
    const bool silent = silent_.seconds() >= silence_max_s_;
    if (ready && was_commanded_ && !commanded() && silent) robot.report(kSilent);
    was_commanded_ = ready && (commanded() || (was_commanded_ && !silent));
  }

  [[nodiscard]] double raw(const ModuleRobot& robot, std::size_t which) const noexcept {
    const auto& place = places_[which];
    return place.has_value() ? robot.read(*place) * signs_[which] : kNoSignal;
  }
  [[nodiscard]] double read(const ModuleRobot& robot, std::size_t which) const noexcept {
    return opposed(which) ? kNoSignal : raw(robot, which);
  }

  void follow(const Tick& tick, ModuleRobot& robot, const GimbalAxis::Measured& yaw,
              double pitch_deg) noexcept {
    const double yaw_rate_deg_s = commanded() ? finiteOr0(input(kYawRate)) : 0.0;
    double pitch_rate_deg_s = commanded() ? finiteOr0(input(kPitchRate)) : 0.0;
    if (commanded() && std::isfinite(input(kYawDeg))) yaw_.aim(input(kYawDeg));
    if (commanded() && std::isfinite(input(kPitchDeg))) pitch_.aim(input(kPitchDeg));
    yaw_.turn(yaw_rate_deg_s, tick.dt_s);
    pitch_.turn(pitch_rate_deg_s, tick.dt_s);
    const double bounded_deg = std::clamp(pitch_.target(), pitch_min_deg_, pitch_max_deg_);
    if (bounded_deg != pitch_.target()) {
      pitch_.aim(bounded_deg);
      pitch_rate_deg_s = 0.0;
    }
    const double yaw_rpm = yaw_.velocityRpm(yaw, yaw_rate_deg_s);
    const double pitch_rpm = pitch_.velocityRpm({pitch_deg, kNoSignal}, pitch_rate_deg_s);
    robot.setTarget(yaw_motor_, {.mode = ControlMode::kVelocity, .value = yaw_rpm});
    robot.setTarget(pitch_motor_, {.mode = ControlMode::kVelocity, .value = pitch_rpm});
  }

  std::size_t yaw_motor_;
  std::size_t pitch_motor_;
  double pitch_min_deg_;
  double pitch_max_deg_;
  double silence_max_s_;
  std::array<std::string, kImuSignals> names_;
  std::array<double, kImuSignals> signs_;
  std::array<std::optional<SignalPlace>, kImuSignals> places_;
  SensedAngle sensed_yaw_;
  SensedAngle sensed_pitch_;
  GimbalAxis yaw_;
  GimbalAxis pitch_;
  MotionMatch yaw_match_{kAngleMatch};
  MotionMatch pitch_match_{kAngleMatch};
  CarriedRate carried_;
  std::array<bool, kImuSignals> told_opposed_{};
  bool was_active_ = false;
  bool was_ready_ = false;
  bool was_by_imu_pitch_ = false;
  bool was_stabilised_ = false;
  bool was_commanded_ = false;
  WatchedTime silent_;
};

class GimbalType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "gimbal"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Yaw and pitch that look in one direction of the world.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kGimbalKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    for (const std::string_view key : {"yaw", "pitch"}) {
      if (auto able = robot.require(ControlMode::kVelocity, own.motor(key), key); !able)
        return tl::unexpected(able.error());
    }
    if (own.motor("yaw") == own.motor("pitch")) return fail("pitch: is the same motor as yaw; name another");
    if (own.number("pitch_min_deg") >= own.number("pitch_max_deg"))
      return fail("pitch_max_deg: must be above pitch_min_deg; change one of them");
    return std::make_unique<Gimbal>(own);
  }
};

}  // namespace

const ModuleType& gimbalType() noexcept {
  static const GimbalType kType;
  return kType;
}

}  // namespace rc10
