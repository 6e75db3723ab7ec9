// Enables one motor, turns it for two seconds, and then brings it to an angle.
//
//   hello_motor ROBOT MOTOR [ANGLE_DEG]        for example: hello_motor demo yaw 90
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <rc10/robot.hpp>
#include <rc10/rtos_task.hpp>

using namespace rc10::literals;
using namespace std::chrono_literals;

namespace {

int failed(const std::string& why) {
  std::fprintf(stderr, "hello_motor: %s\n", why.c_str());
  return 1;
}

int run(const std::string& robot_name, const std::string& motor_name, rc10::Degrees angle) {
  rc10::RobotOptions options;
  options.client = "hello-motor";
  options.at_end = rc10::AtEnd::kDisable;  // without it each motor does its on_timeout, and stays ACTIVE
  rc10::Robot robot(robot_name, options);
  if (const auto heard = robot.waitForState(); !heard) return failed(heard.error().message);

  const auto motor = robot.motor(motor_name);
  if (const auto enabled = motor.enable(); !enabled) return failed(enabled.error().message);

  // A target is held until another is set: no loop is needed to keep the motor going.
  if (const auto set = motor.setTargetRPM(60_rpm); !set) return failed(set.error().message);
  rc10::Rate rate(100ms);
  for (int i = 0; i < 20; ++i) {
    rate.wait();
    const auto state = motor.state();
    std::printf("%6.1f rpm  %7.1f deg  %6.2f A\n", state.velocity_rpm, state.total_angle_deg,
                state.current_a);
  }

  const auto result = motor.moveTo(angle, 2_deg, 10s).get();
  if (!result) return failed(result.reason);
  std::printf("%s stands at %.1f deg\n", motor_name.c_str(), result.angle_deg);
  return 0;
  // Leaving the block has disabled the motor.
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return failed("usage: hello_motor ROBOT MOTOR [ANGLE_DEG]");
  return run(argv[1], argv[2], argc > 3 ? rc10::Degrees{std::strtod(argv[3], nullptr)} : 90_deg);
}
