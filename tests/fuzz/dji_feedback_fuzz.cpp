// Arbitrary frames, orders and targets to DJI motors: whatever comes, readings stay finite, angles in
// [0, 360), efforts and raw commands within their limits.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "drives/dji/dji_group.hpp"
#include "fuzz_input.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

MotorSettings config(const DjiModel& model, int id, DjiCommand command, bool incremental) {
  MotorSettings result;
  result.name = std::string{model.name} + std::to_string(id);
  result.model = model.name;
  result.id = id;
  result.own.set("command", std::string{command == DjiCommand::kVoltage ? "voltage" : "current"});
  result.direction = id % 2 == 0 ? -1 : 1;
  result.effort_limit = 2.5F;
  result.loops = model.command(command).default_loops;
  if (incremental) {
    result.loops.velocity =
        PID_Incremental::Config{.kp = 0.1F, .ki = 1.0F, .kd = 0.01F, .tracking_rad_s = 50.0F};
  }
  require(DJI_Motor::check(result).has_value());
  return result;
}

void checkMotor(const DJI_Motor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  require(std::abs(motor.commandValue()) <= 2.5F);
  const int full_scale = motor.model().command(motor.command()).raw_full_scale;
  require(std::abs(static_cast<int>(motor.rawCommand())) <= full_scale);
  if (feedback.samples == 0) return;
  require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  require(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.velocity_rpm));
  require(std::isfinite(feedback.current_a) && std::isfinite(feedback.torque_nm));
}

CanFrame takeFrame(Input& input) {
  CanFrame frame;
  const auto head = input.take<std::uint32_t>();
  frame.id = {0x200U + (head & 0xFU), (head & 0x1000U) != 0};
  frame.fd = (head & 0x2000U) != 0;
  frame.type = (head & 0x4000U) != 0 ? FrameType::kRemote : FrameType::kData;
  const auto odd = static_cast<std::uint8_t>((head >> 16U) & 0x3FU);
  frame.length = odd < 48 ? std::uint8_t{8} : odd;
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  return frame;
}

Target takeTarget(Input& input) {
  Target target;
  target.mode = static_cast<ControlMode>(input.take<std::uint8_t>());
  target.value = input.take<double>();
  target.velocity_ff_rpm = input.take<float>();
  target.torque_ff_nm = input.take<float>();
  return target;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  DJI_Motor wheel(config(kM3508, 1, DjiCommand::kCurrent, false));
  DJI_Motor arm(config(kM2006, 2, DjiCommand::kCurrent, true));
  DJI_Motor yaw(config(kGM6020, 1, DjiCommand::kCurrent, false));
  DJI_Motor pitch(config(kGM6020, 2, DjiCommand::kVoltage, true));
  const std::array<DJI_Motor*, 4> motors{&wheel, &arm, &yaw, &pitch};
  DJI_Group group({0x200, false});
  require(group.registerMotor(wheel).has_value() && group.registerMotor(arm).has_value());

  Input input(data, size);
  MonotonicTime now{std::chrono::hours{1}};
  Tick tick;
  while (!input.empty()) {
    const auto action = input.take<std::uint8_t>();
    DJI_Motor& motor = *motors[action % motors.size()];
    switch ((action >> 2U) % 6U) {
      case 0: motor.order(static_cast<FrameKind>(input.take<std::uint8_t>() % 8U)); break;
      case 1: (void)motor.setTarget(takeTarget(input)); break;
      case 2: (void)motor.setZero(input.take<double>()); break;
      case 3: motor.derate(input.take<float>()); break;
      default: {
        CanFrame frame = takeFrame(input);
        frame.received = now += Duration{input.take<std::int32_t>()};
        for (DJI_Motor* each : motors) {
          if (each->matchesFrame(frame)) (void)each->updateFeedback(frame);
        }
      }
    }
    ++tick.index;
    tick.now = now;
    for (DJI_Motor* each : motors) {
      each->update(tick);
      checkMotor(*each);
    }
    std::array<CanFrame, 1> out{};
    require(group.packCommand(tick, out) == 1 && out[0].length == 8);
  }
  return 0;
}
