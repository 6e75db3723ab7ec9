#include "module/chassis.hpp"

#include <algorithm>
#include <array>

#include "app/differential_kinematics.hpp"
#include "app/mecanum_kinematics.hpp"
#include "app/omni_kinematics.hpp"
#include "module/chassis_keys.hpp"
#include "module/wheeled_chassis.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

constexpr std::array kThree{motorKey("left", "Its motor. Positive pushes the robot round counter-clockwise."),
                            motorKey("right", "Its motor."),
                            motorKey("middle", "The motor of the wheel on the centre line.")};
constexpr std::array kSides{motorKey("left", "Its motor. Positive drives the robot forward."),
                            motorKey("right", "Its motor.")};
constexpr std::array<std::string_view, 2> kMiddles{"rear", "front"};

template <typename Kinematics, typename Wheels>
Result<std::unique_ptr<Module_Base>> make(const OwnValues& own, const RobotOutline& robot,
                                          std::span<const OwnKey> names, const Kinematics& kinematics) {
  const auto motors = motorsOf(own, "wheels", names, ControlMode::kVelocity, robot);
  if (!motors) return tl::unexpected(motors.error());
  if (auto powered = checkPowerLimit(own, *motors, robot); !powered) return tl::unexpected(powered.error());
  const auto limit_rpm = wheelLimit(own, *motors, robot);
  if (!limit_rpm) return tl::unexpected(limit_rpm.error());
  std::array<std::size_t, Wheels::kAll.size()> places{};
  std::copy(motors->begin(), motors->end(), places.begin());
  return std::make_unique<WheeledChassis<Kinematics, Wheels>>(own, kinematics, places, *limit_rpm);
}

/// Four wheels at the corners: only their kinematics differ.
template <typename Kinematics, typename Wheels>
class CornerChassisType : public ChassisType {
 public:
  CornerChassisType(std::string_view name, std::string_view about) : name_(name), about_(about) {}
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::string_view about() const noexcept override { return about_; }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override {
    static const auto kAll = withCommonKeys(
        {wheelsKey("wheels", kCornerKeys), kWheelRadiusKey, kTrackKey, kWheelbaseKey, kWheelLimitKey});
    return kAll;
  }
  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    return make<Kinematics, Wheels>(own, robot, kCornerKeys,
                                    Kinematics{{own.number("wheel_radius_m"), own.number("track_m") / 2.0,
                                                own.number("wheelbase_m") / 2.0}});
  }

 private:
  std::string_view name_;
  std::string_view about_;
};

class Omni3ChassisType : public ChassisType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "omni3_chassis"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Three omni wheels at 120 degrees: drives in every direction.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override {
    static const auto kAll =
        withCommonKeys({wheelsKey("wheels", kThree), kWheelRadiusKey,
                        lengthKey("centre_distance_m", "From the middle of the robot to each wheel."),
                        OwnKey{.name = "middle_wheel",
                               .kind = kChoice,
                               .choices = kMiddles,
                               .default_text = "rear",
                               .about = "Where the wheel on the centre line is."},
                        kWheelLimitKey});
    return kAll;
  }
  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    const auto middle = own.text("middle_wheel") == "front" ? Omni3Kinematics::MiddleWheel::kFront
                                                            : Omni3Kinematics::MiddleWheel::kRear;
    return make<Omni3Kinematics, Omni3Wheels>(
        own, robot, kThree,
        Omni3Kinematics{{own.number("wheel_radius_m"), own.number("centre_distance_m"), middle}});
  }
};

class DifferentialChassisType : public ChassisType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "differential_chassis"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "A driven wheel or track on each side: drives forward and turns.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override {
    static const auto kAll =
        withCommonKeys({wheelsKey("wheels", kSides), kWheelRadiusKey, kTrackKey, kWheelLimitKey});
    return kAll;
  }
  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    return make<DifferentialKinematics, DifferentialWheels>(
        own, robot, kSides,
        DifferentialKinematics{{own.number("wheel_radius_m"), own.number("track_m") / 2.0}});
  }
};

}  // namespace

const ModuleType& mecanumChassisType() noexcept {
  static const CornerChassisType<MecanumKinematics, MecanumWheels> kType{
      "mecanum_chassis", "Four mecanum wheels: drives in every direction."};
  return kType;
}

const ModuleType& omni4ChassisType() noexcept {
  static const CornerChassisType<Omni4Kinematics, Omni4Wheels> kType{
      "omni4_chassis", "Four omni wheels at the corners at 45 degrees: drives in every direction."};
  return kType;
}

const ModuleType& omni3ChassisType() noexcept {
  static const Omni3ChassisType kType;
  return kType;
}

const ModuleType& differentialChassisType() noexcept {
  static const DifferentialChassisType kType;
  return kType;
}

}  // namespace rc10
