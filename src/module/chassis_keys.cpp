#include "module/chassis_keys.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "module/chassis_base.hpp"
#include "module/shared_limit.hpp"

namespace rc10 {

std::vector<OwnKey> withCommonKeys(std::initializer_list<OwnKey> own) {
  std::vector<OwnKey> all{own};
  const auto common = Chassis_Base::commonKeys();
  all.insert(all.end(), common.begin(), common.end());
  return all;
}

Result<std::vector<std::size_t>> motorsOf(const OwnValues& own, std::string_view key,
                                          std::span<const OwnKey> names, ControlMode mode,
                                          const RobotOutline& robot) {
  const auto& section = own.section(key);
  std::vector<std::size_t> motors;
  for (const auto& name : names) {
    const std::string path = std::string{key} + "." + std::string{name.name};
    const auto motor = section.motor(name.name);
    if (auto able = robot.require(mode, motor, path); !able) return tl::unexpected(able.error());
    if (std::find(motors.begin(), motors.end(), motor) != motors.end())
      return fail(path + ": motor '" + robot.motors[motor].name + "' is given twice");
    motors.push_back(motor);
  }
  return motors;
}

Result<void> checkPowerLimit(const OwnValues& own, const std::vector<std::size_t>& motors,
                             const RobotOutline& robot) {
  if (!(own.number("power_limit_w") > 0.0)) return {};
  for (const auto motor : motors) {
    const auto& wheel = robot.motors[motor];
    if (wheel.unreported_torque_remedy.empty()) continue;
    return fail("power_limit_w: motor '" + wheel.name +
                "' reports no torque, of which the power is computed: the limit would never act; " +
                std::string{wheel.unreported_torque_remedy} + ", or remove it");
  }
  return {};
}

Result<double> wheelLimit(const OwnValues& own, const std::vector<std::size_t>& motors,
                          const RobotOutline& robot) {
  const double limit_rpm = lowestLimitRpm(robot, motors);
  if (own.given("wheel_limit_rpm")) return std::min(own.number("wheel_limit_rpm"), limit_rpm);
  if (limit_rpm < std::numeric_limits<double>::infinity()) return limit_rpm;
  return fail("wheel_limit_rpm: is missing, and no motor of it has a velocity_limit_rpm; add one of them");
}

}  // namespace rc10
