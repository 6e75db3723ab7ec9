#include "module/synchronised_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "module/shared_limit.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

constexpr std::array kPairKeys{
    OwnKey{.name = "left",
           .kind = kMotor,
           .required = true,
           .about = "One of the two motors; both need velocity and total_angle targets, and a reference."},
    OwnKey{.name = "right", .kind = kMotor, .required = true, .about = "The other."},
    OwnKey{
        .name = "max_difference_deg",
        .kind = kNumber,
        .unit = "deg",
        .max = 3600,
        .above_min = true,
        .default_text = "10",
        .about = "Beyond this difference the pair rests, until both have been disabled and enabled again."},
    OwnKey{.name = "correction_rpm_per_deg",
           .kind = kNumber,
           .unit = "rpm/deg",
           .max = 1000,
           .default_text = "0.5",
           .about = "Velocity by which each motor is drawn to the middle of both, for each degree that it "
                    "is away from it."},
    OwnKey{.name = "velocity_limit_rpm",
           .kind = kNumber,
           .unit = "rpm",
           .max = 100'000,
           .above_min = true,
           .required = true,
           .about = "Bound of velocity targets."}};

ModuleSignals pairSignals() {
  return {
      .inputs = {"velocity_rpm", "total_angle_deg"},
      .outputs = {"total_angle_deg", "difference_deg", "apart"},
      .events = {{.text = "its motors have come too far apart: they rest; disable both, bring them together "
                          "and enable them again"}}};
}

class SynchronisedPair : public Module_Base {
 public:
  SynchronisedPair(const OwnValues& own, double limit_rpm)
      : Module_Base(pairSignals()),
        motors_{own.motor("left"), own.motor("right")},
        max_difference_deg_(own.number("max_difference_deg")),
        correction_rpm_per_deg_(own.number("correction_rpm_per_deg")),
        velocity_limit_rpm_(limit_rpm) {}

  void update(const Tick&, ModuleRobot& robot) noexcept override {
    // At one instant: after a pause or a lost frame one sample may be much older than the other.
    const MonotonicTime at =
        std::max(robot.feedback(motors_[0]).received, robot.feedback(motors_[1]).received);
    const double left_deg = angleAt(robot.feedback(motors_[0]), at);
    const double right_deg = angleAt(robot.feedback(motors_[1]), at);
    const double difference_deg = left_deg - right_deg;
    const bool referenced = robot.feedback(motors_[0]).zeroed && robot.feedback(motors_[1]).zeroed;
    const bool active =
        robot.status(motors_[0]) == MotorStatus::kActive && robot.status(motors_[1]) == MotorStatus::kActive;
    if (!active) apart_ = false;
    if (active && referenced && !apart_ && !(std::fabs(difference_deg) <= max_difference_deg_)) {
      apart_ = true;
      robot.report(kCameApart);
    }
    setOutput(kAngleOut, (left_deg + right_deg) / 2.0);
    setOutput(kDifference, referenced ? difference_deg : kNoSignal);
    setOutput(kApart, apart_ ? 1.0 : 0.0);
    if (!active || !referenced || apart_ || !commanded()) return;
    if (std::isfinite(input(kTotalAngleDeg))) {
      for (const auto motor : motors_)
        robot.setTarget(motor, {.mode = ControlMode::kTotalAngle, .value = input(kTotalAngleDeg)});
    } else if (std::isfinite(input(kVelocityRpm))) {
      // Speeds that both can reach: at the limit the one that is ahead is still slowed.
      const double limit_rpm = sharedLimitRpm(robot, motors_, velocity_limit_rpm_);
      const double both_rpm = std::clamp(input(kVelocityRpm), -limit_rpm, limit_rpm);
      const double pull_rpm = correction_rpm_per_deg_ * difference_deg / 2.0;
      turn(robot, motors_[0], both_rpm - pull_rpm, limit_rpm);
      turn(robot, motors_[1], both_rpm + pull_rpm, limit_rpm);
    }
  }

 private:
  enum Input : std::size_t { kVelocityRpm, kTotalAngleDeg };
  enum Output : std::size_t { kAngleOut, kDifference, kApart };
  enum EventPlace : std::size_t { kCameApart };

  [[nodiscard]] static double angleAt(const MotorFeedback& feedback, MonotonicTime at) noexcept {
    const auto rpm = static_cast<double>(finiteOr0(feedback.velocity_rpm));
    return feedback.total_angle_deg +
           rpm * kDegPerSPerRpm * static_cast<double>(seconds(at - feedback.received));
  }

  static void turn(ModuleRobot& robot, std::size_t motor, double velocity_rpm, double limit_rpm) noexcept {
    robot.setTarget(
        motor, {.mode = ControlMode::kVelocity, .value = std::clamp(velocity_rpm, -limit_rpm, limit_rpm)});
  }

  std::array<std::size_t, 2> motors_;
  double max_difference_deg_;
  double correction_rpm_per_deg_;
  double velocity_limit_rpm_;
  bool apart_ = false;
};

class SynchronisedPairType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "synchronised_pair"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Two motors that move one thing and must stay together.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kPairKeys; }

  [[nodiscard]] Coupling coupling() const noexcept override { return Coupling::kTogether; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    if (own.motor("left") == own.motor("right"))
      return fail("right: is the same motor as left; name another");
    for (const std::string_view key : {"left", "right"}) {
      for (const auto mode : {ControlMode::kVelocity, ControlMode::kTotalAngle}) {
        if (auto able = robot.require(mode, own.motor(key), key); !able) return tl::unexpected(able.error());
      }
    }
    const std::array motors{own.motor("left"), own.motor("right")};
    return std::make_unique<SynchronisedPair>(
        own, std::min(own.number("velocity_limit_rpm"), lowestLimitRpm(robot, motors)));
  }
};

}  // namespace

const ModuleType& synchronisedPairType() noexcept {
  static const SynchronisedPairType kType;
  return kType;
}

}  // namespace rc10
