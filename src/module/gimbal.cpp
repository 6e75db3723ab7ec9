#include "module/gimbal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "module/gimbal_axis.hpp"

namespace rc10 {
namespace {

using enum FamilyKey::Kind;

constexpr FamilyKey signalKey(std::string_view name, std::string_view about) {
  return {.name = name, .kind = kText, .about = about, .pattern = kSignalPattern, .words = kSignalWords};
}
constexpr FamilyKey limitKey(std::string_view name, double value_if_not, std::string_view default_text,
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
    FamilyKey{.name = "yaw",
              .kind = kMotor,
              .required = true,
              .about = "The motor that turns about the vertical; it needs velocity targets and an absolute "
                       "angle, 0 where "
                       "the gimbal looks to the front of the chassis."},
    FamilyKey{.name = "pitch",
              .kind = kMotor,
              .required = true,
              .about = "The motor that lifts; the same, 0 where it looks level."},
    signalKey("imu_yaw",
              "The yaw of an inertial sensor on the gimbal, deg. Default: none; it holds to the chassis."),
    signalKey("imu_yaw_rate", "Its rate, deg/s: with it the turning of the chassis is taken off at once."),
    signalKey("imu_pitch", "The pitch of that sensor, deg. Default: the motor's angle."),
    limitKey("pitch_min_deg", 90, "-20", "No lower does it look."),
    limitKey("pitch_max_deg", 90, "30", "Nor higher."),
    FamilyKey{.name = "gain_per_s",
              .kind = kNumber,
              .unit = "1/s",
              .max = 100,
              .above_min = true,
              .default_text = "10",
              .about = "Of both axes: deg/s for each degree that is missing."},
    FamilyKey{.name = "velocity_limit_rpm",
              .kind = kNumber,
              .unit = "rpm",
              .max = 1000,
              .above_min = true,
              .default_text = "60",
              .about = "No axis is told more."},
    FamilyKey{.name = "silence_max_s",
              .kind = kNumber,
              .unit = "s",
              .max = 3600,
              .default_text = "10",
              .about = "So long it holds its direction when nobody commands it; then its motors do their "
                       "on_timeout."}};

ModuleSignals gimbalSignals() {
  return {
      .inputs = {"yaw_deg", "pitch_deg", "yaw_rate_deg_s", "pitch_rate_deg_s"},
      .outputs = {"yaw_deg", "pitch_deg", "relative_yaw_deg", "target_yaw_deg", "target_pitch_deg",
                  "stabilised"},
      .events = {{.text = "the inertial sensor is not heard: the gimbal holds to the chassis"},
                 {.text = "the inertial sensor is heard: the gimbal holds to the world", .expected = true},
                 {.text = "nobody has commanded it for silence_max_s: it holds its direction no longer"}}};
}

class Gimbal : public Module_Base {
 public:
  explicit Gimbal(const OwnValues& own)
      : Module_Base(gimbalSignals()),
        yaw_motor_(own.motor("yaw")),
        pitch_motor_(own.motor("pitch")),
        pitch_min_deg_(own.number("pitch_min_deg")),
        pitch_max_deg_(own.number("pitch_max_deg")),
        silence_max_(std::chrono::milliseconds{static_cast<int>(own.number("silence_max_s") * 1000.0)}),
        names_{own.text("imu_yaw"), own.text("imu_yaw_rate"), own.text("imu_pitch")},
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
    const double imu_yaw_deg = read(robot, 0);
    const bool stabilised = std::isfinite(imu_yaw_deg);
    const double yaw_deg = stabilised ? imu_yaw_deg : static_cast<double>(yaw.angle_deg);
    const double imu_pitch_deg = read(robot, 2);
    const double motor_pitch_deg = std::remainder(static_cast<double>(pitch.angle_deg), kDegPerTurn);
    const double pitch_deg = std::isfinite(imu_pitch_deg) ? imu_pitch_deg : motor_pitch_deg;
    const bool ready = robot.obeys(yaw_motor_) && robot.obeys(pitch_motor_) && yaw.zeroed && pitch.zeroed;
    // Another frame, another angle: it goes on looking where it looks.
    if (!ready || !was_ready_ || stabilised != was_stabilised_) {
      if (was_ready_ && ready && places_[0]) robot.report(stabilised ? kBack : kLost);
      yaw_.hold(yaw_deg);
      pitch_.hold(pitch_deg);
    }
    was_ready_ = ready;
    was_stabilised_ = stabilised;
    if (ready && was_commanded_)
      follow(tick, robot, {yaw_deg, stabilised ? read(robot, 1) : kNoSignal}, pitch_deg);
    holdOn(ready, tick, robot);
    setOutput(kOutYaw, std::remainder(yaw_deg, kDegPerTurn));
    setOutput(kOutPitch, pitch_deg);
    setOutput(kRelativeYaw,
              yaw.zeroed ? std::remainder(static_cast<double>(yaw.angle_deg), kDegPerTurn) : kNoSignal);
    setOutput(kTargetYaw, std::remainder(yaw_.target(), kDegPerTurn));
    setOutput(kTargetPitch, pitch_.target());
    setOutput(kStabilised, stabilised ? 1.0 : 0.0);
  }

 private:
  enum Input : std::size_t { kYawDeg, kPitchDeg, kYawRate, kPitchRate };
  enum Output : std::size_t { kOutYaw, kOutPitch, kRelativeYaw, kTargetYaw, kTargetPitch, kStabilised };
  enum EventPlace : std::size_t { kLost, kBack, kSilent };

  struct YawMeasured {
    double angle_deg;
    double rate_deg_s;
  };

  // Once commanded it holds its direction for a while: a gimbal that falls is no rest. Not for ever: with its
  // client it may have lost its reason.
  void holdOn(bool ready, const Tick& tick, ModuleRobot& robot) noexcept {
    if (commanded()) commanded_at_ = tick.now;
    const bool silent = tick.now - commanded_at_ >= silence_max_;
    if (ready && was_commanded_ && !commanded() && silent) robot.report(kSilent);
    was_commanded_ = ready && (commanded() || (was_commanded_ && !silent));
  }

  [[nodiscard]] double read(const ModuleRobot& robot, std::size_t which) const noexcept {
    const auto& place = places_[which];
    return place.has_value() ? robot.read(*place) : kNoSignal;
  }

  void follow(const Tick& tick, ModuleRobot& robot, const YawMeasured& yaw, double pitch_deg) noexcept {
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
    const auto rpm_of = [&](std::size_t motor) {
      return static_cast<double>(robot.feedback(motor).velocity_rpm);
    };
    const double yaw_rpm =
        yaw_.velocityRpm({yaw.angle_deg, yaw.rate_deg_s, rpm_of(yaw_motor_)}, yaw_rate_deg_s);
    const double pitch_rpm =
        pitch_.velocityRpm({pitch_deg, kNoSignal, rpm_of(pitch_motor_)}, pitch_rate_deg_s);
    robot.setTarget(yaw_motor_, {.mode = ControlMode::kVelocity, .value = yaw_rpm});
    robot.setTarget(pitch_motor_, {.mode = ControlMode::kVelocity, .value = pitch_rpm});
  }

  std::size_t yaw_motor_;
  std::size_t pitch_motor_;
  double pitch_min_deg_;
  double pitch_max_deg_;
  Duration silence_max_;
  std::array<std::string, 3> names_;
  std::array<std::optional<SignalPlace>, 3> places_;
  GimbalAxis yaw_;
  GimbalAxis pitch_;
  bool was_ready_ = false;
  bool was_stabilised_ = false;
  bool was_commanded_ = false;
  MonotonicTime commanded_at_{};
};

class GimbalType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "gimbal"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Yaw and pitch that look in one direction of the world.";
  }
  [[nodiscard]] std::span<const FamilyKey> keys() const noexcept override { return kGimbalKeys; }

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
