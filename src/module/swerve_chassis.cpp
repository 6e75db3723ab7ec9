#include "module/swerve_chassis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/swerve_kinematics.hpp"
#include "module/chassis_base.hpp"
#include "module/chassis_keys.hpp"
#include "module/shared_limit.hpp"
#include "module/travel_of_motors.hpp"

namespace rc10 {
namespace {

constexpr std::size_t kCount = SwerveModules::kAll.size();
using Motors = std::array<std::size_t, kCount>;

class SwerveChassis final : public Chassis_Base {
 public:
  SwerveChassis(const OwnValues& own, const SwerveKinematics& kinematics, const Motors& drives,
                const Motors& steerings, double limit_rpm)
      : Chassis_Base(own, joined(drives, steerings)),
        kinematics_(kinematics),
        drives_(drives),
        steerings_(steerings),
        limit_rpm_(limit_rpm),
        travel_(kCount, limit_rpm) {}

 protected:
  // A wheel whose direction nobody knows would drive anywhere.
  [[nodiscard]] bool ready(const ModuleRobot& robot) const noexcept override {
    return std::all_of(steerings_.begin(), steerings_.end(),
                       [&](std::size_t motor) { return robot.feedback(motor).zeroed; });
  }

  void drive(const Twist2D& body, ModuleRobot& robot) noexcept override {
    const auto now = modules(robot, [&](std::size_t i) { return velocity(robot, i); });
    const auto limit_rpm = sharedLimitRpm(robot, drives_, limit_rpm_);
    const auto wanted = steered(limited(kinematics_.inverse(body, now), limit_rpm), now);
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto& module = wanted.*SwerveModules::kAll[i];
      robot.setTarget(drives_[i], {.mode = ControlMode::kVelocity, .value = module.speed_rpm});
      robot.setTarget(steerings_[i], {.mode = ControlMode::kAngle, .value = module.angle_deg});
    }
  }

  [[nodiscard]] Twist2D measured(const ModuleRobot& robot) const noexcept override {
    return kinematics_.forward(modules(robot, [&](std::size_t i) { return velocity(robot, i); }));
  }

  [[nodiscard]] Twist2D travelled(const ModuleRobot& robot, float dt_s) noexcept override {
    return kinematics_.forward(
        modules(robot, [&](std::size_t i) { return travel_.meanRpm(i, robot.feedback(drives_[i]), dt_s); }));
  }

 private:
  [[nodiscard]] static std::vector<std::size_t> joined(const Motors& drives, const Motors& steerings) {
    std::vector<std::size_t> all{drives.begin(), drives.end()};
    all.insert(all.end(), steerings.begin(), steerings.end());
    return all;
  }

  [[nodiscard]] double velocity(const ModuleRobot& robot, std::size_t wheel) const noexcept {
    return static_cast<double>(robot.feedback(drives_[wheel]).velocity_rpm);
  }

  template <typename SpeedOf>
  [[nodiscard]] SwerveModules modules(const ModuleRobot& robot, SpeedOf speed_of) const noexcept {
    SwerveModules all;
    for (std::size_t i = 0; i < kCount; ++i) {
      all.*SwerveModules::kAll[i] = {
          .speed_rpm = speed_of(i),
          .angle_deg = static_cast<double>(robot.feedback(steerings_[i]).angle_deg)};
    }
    return all;
  }

  SwerveKinematics kinematics_;
  Motors drives_;
  Motors steerings_;
  double limit_rpm_;
  TravelOfMotors travel_;
};

class SwerveChassisType : public ChassisType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "swerve_chassis"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Four steered and driven wheels: drives in every direction.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override {
    static const auto kAll = withCommonKeys({wheelsKey("drive", kCornerKeys), wheelsKey("steer", kCornerKeys),
                                             kWheelRadiusKey, kTrackKey, kWheelbaseKey, kWheelLimitKey});
    return kAll;
  }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    const auto drives = motorsOf(own, "drive", kCornerKeys, ControlMode::kVelocity, robot);
    if (!drives) return tl::unexpected(drives.error());
    const auto steerings = motorsOf(own, "steer", kCornerKeys, ControlMode::kAngle, robot);
    if (!steerings) return tl::unexpected(steerings.error());
    for (const auto motor : *steerings) {
      if (std::find(drives->begin(), drives->end(), motor) != drives->end())
        return fail("steer: motor '" + robot.motors[motor].name + "' drives a wheel already; name another");
    }
    for (const auto* motors : {&*drives, &*steerings}) {
      if (auto powered = checkPowerLimit(own, *motors, robot); !powered)
        return tl::unexpected(powered.error());
    }
    const auto limit_rpm = wheelLimit(own, *drives, robot);
    if (!limit_rpm) return tl::unexpected(limit_rpm.error());
    Motors drive_places{};
    Motors steer_places{};
    std::copy(drives->begin(), drives->end(), drive_places.begin());
    std::copy(steerings->begin(), steerings->end(), steer_places.begin());
    const SwerveKinematics kinematics{{.wheel_radius_m = own.number("wheel_radius_m"),
                                       .half_track_m = own.number("track_m") / 2.0,
                                       .half_wheelbase_m = own.number("wheelbase_m") / 2.0}};
    return std::make_unique<SwerveChassis>(own, kinematics, drive_places, steer_places, *limit_rpm);
  }
};

}  // namespace

const ModuleType& swerveChassisType() noexcept {
  static const SwerveChassisType kType;
  return kType;
}

}  // namespace rc10
