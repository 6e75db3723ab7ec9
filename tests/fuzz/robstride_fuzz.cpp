// Arbitrary frames, orders and targets to RobStride motors and their simulated drives: whatever comes,
// readings stay finite, frames valid and within the limits.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "../support/robstride_settings.hpp"
#include "bus/byte_order.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr float kLimitA = 2.5F;

MotorSettings settingsFrom(Input& input) {
  const auto models = robstrideModels();
  const auto choice = input.take<std::uint8_t>();
  auto settings = test::robStrideSettings(models[choice % models.size()].name, 5);
  constexpr std::array<const char*, 4> kControls{"operation", "current", "velocity", "position"};
  const auto more = input.take<std::uint8_t>();
  settings.own.set("control", std::string{kControls[more & 3U]});
  settings.direction = (more & 4U) != 0 ? -1 : 1;
  settings.gear_ratio = (more & 8U) != 0 ? 30.0 : 0.0;
  settings.velocity_limit_rpm = (more & 16U) != 0 ? 100.0F : 0.0F;
  settings.effort_limit = kLimitA;
  settings.command_divider = (more & 32U) != 0 ? 3 : 1;
  return settings;
}

CanFrame takeFrame(Input& input) {
  CanFrame frame;
  const auto head = input.take<std::uint32_t>();
  constexpr std::array<std::uint32_t, 6> kTypes{2, 17, 21, 24, 3, 18};
  frame.id = {kTypes[head % kTypes.size()] << 24U | (head & 0xFF0000U) | 0x05FDU, (head & 0x100U) == 0};
  frame.fd = (head & 0x600U) == 0x600U;
  frame.type = (head & 0x1800U) == 0x1800U ? FrameType::kRemote : FrameType::kData;
  frame.length = static_cast<std::uint8_t>((head & 0xE000U) == 0xE000U ? head >> 29U : 8U);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  return frame;
}

void checkReadings(const RobStride_Motor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  require(std::isnan(feedback.voltage_v) || std::isfinite(feedback.voltage_v));
  (void)motor.complaint();
  if (feedback.samples == 0) return;
  require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  require(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.velocity_rpm));
  require(std::isfinite(feedback.current_a) && std::isfinite(feedback.torque_nm));
  require(std::isfinite(feedback.temperature_c));
}

void checkSent(const CanFrame& frame, const robstride::Codec& codec) {
  require(frame.id.extended && frame.id.value <= kExtendedIdMask && frame.length == 8 && !frame.fd);
  require((frame.id.value & 0xFFU) == 5);
  const auto type = frame.id.value >> 24U;
  require(type == 1 || type == 3 || type == 4 || type == 17 || type == 18);
  if (type == 1) {
    const double lsb_nm = 3.0 * codec.model->torque_range_nm / 65535;
    const auto told = codec.operation(frame);
    require(std::abs(told.torque_nm) <= static_cast<double>(kLimitA) * codec.model->torqueNmPerA() + lsb_nm);
  } else if (type == 18) {
    const auto index = readLittleEndian<std::uint16_t>(frame.payload(), 0);
    const auto value = readLittleEndian<float>(frame.payload(), 4);
    require(std::isfinite(value));
    if (index == robstride::parameter::kCurrentRef || index == robstride::parameter::kCurrentLimit) {
      require(std::abs(value) <= kLimitA);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const auto settings = settingsFrom(input);
  RobStride_Motor motor(settings);
  sim::RobstrideDrive drive(settings, {});
  const auto* model = findRobstrideModel(settings.model);
  const robstride::Codec codec{
      .model = model, .position_range_rad = model->position_range_rad, .drive_id = 5, .host_id = 253};
  Tick tick;
  tick.now = MonotonicTime{std::chrono::hours{1}};
  while (!input.empty()) {
    const auto action = input.take<std::uint8_t>();
    switch (action % 8U) {
      case 0: motor.order(static_cast<FrameKind>(input.take<std::uint8_t>() % 9U)); break;
      case 1: (void)motor.setTarget(fuzz::takeTarget(input)); break;
      case 2: motor.order(FrameKind::kCommand, fuzz::takeTarget(input)); break;
      case 3: motor.derate(input.take<float>()); break;
      case 4:
        (void)motor.setZero(input.take<double>());
        motor.clearComplaint();
        break;
      case 5: drive.fault(input.take<std::uint32_t>()); break;
      case 6: {
        CanFrame frame = takeFrame(input);
        frame.received = tick.now;
        if (motor.matchesFrame(frame)) (void)motor.updateFeedback(frame);
        frame.id.value = (frame.id.value & 0x1FFF'0000U) | 0xFD05U;
        drive.receive(frame);
        break;
      }
      default: tick.now += Duration{input.take<std::uint32_t>()}; break;
    }
    ++tick.index;
    tick.now += std::chrono::milliseconds{1};
    motor.update(tick);
    checkReadings(motor);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor.packCommand(tick, out);
    require(count <= out.size());
    for (std::size_t i = 0; i < count; ++i) {
      checkSent(out[i], codec);
      drive.receive(out[i]);
    }
    drive.step(std::chrono::milliseconds{1});
    std::array<CanFrame, sim::Drive::kMaxFrames> in{};
    const auto answers = drive.answers(in);
    for (std::size_t i = 0; i < answers; ++i) {
      in[i].received = tick.now;
      require(in[i].length == 8 && in[i].id.extended && in[i].id.value <= kExtendedIdMask);
      if (motor.matchesFrame(in[i])) (void)motor.updateFeedback(in[i]);
    }
  }
  return 0;
}
