// Arbitrary frames, orders and targets to ODrive motors: whatever comes, readings are finite or not reported,
// and every frame sent is a valid one of the node, within the limits.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "bus/byte_order.hpp"
#include "drives/odrive/odrive_motor.hpp"
#include "motor_orders.hpp"
#include "support/odrive_settings.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr float kTorqueLimitNm = 1.001F;      // 20 A at 0.05 N·m/A, before the gear
constexpr float kSpeedLimit = 25.01F * 3.0F;  // 1500 rpm behind the largest gear here

void checkReadings(const ODrive_Motor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  require(std::isfinite(motor.commandValue()));
  for (const float reading :
       {feedback.current_a, feedback.torque_nm, feedback.voltage_v, feedback.temperature_c}) {
    require(!std::isinf(reading));
  }
  if (feedback.samples == 0) return;
  require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  require(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.velocity_rpm));
}

float numberAt(const CanFrame& frame, std::size_t at) { return readLittleEndian<float>(frame.payload(), at); }

void checkFrame(const CanFrame& frame, int node, FrameKind kind) {
  require(!frame.id.extended && !frame.fd && frame.type == FrameType::kData);
  require((frame.id.value >> odrive::kMessageBits) == static_cast<std::uint32_t>(node));
  const bool obeys_targets =
      kind == FrameKind::kCommand || kind == FrameKind::kBrake || kind == FrameKind::kHold;
  switch (odrive::messageOf(frame.id)) {
    case odrive::Message::kSetAxisState:
      require(frame.length == 4 && (frame.data[0] == 1 || frame.data[0] == 8));
      require(frame.data[0] == 1 || kind == FrameKind::kEnable);
      break;
    case odrive::Message::kSetControllerMode:
      require(frame.length == 8 && frame.data[0] >= 1 && frame.data[0] <= 3 && frame.data[4] == 1);
      break;
    case odrive::Message::kSetInputPos:
      require(obeys_targets && frame.length == 8 && std::abs(numberAt(frame, 0)) <= 1e5F);
      break;
    case odrive::Message::kSetInputVel:
      require(frame.length == 8 && std::abs(numberAt(frame, 0)) <= kSpeedLimit);
      require(std::abs(numberAt(frame, 4)) <= kTorqueLimitNm);
      // While it is enabled an old input is replaced.
      require(obeys_targets ||
              (kind == FrameKind::kEnable && numberAt(frame, 0) == 0.0F && numberAt(frame, 4) == 0.0F));
      break;
    case odrive::Message::kSetInputTorque:
      require(frame.length == 4 && std::abs(numberAt(frame, 0)) <= kTorqueLimitNm);
      require(obeys_targets || numberAt(frame, 0) == 0.0F);
      break;
    case odrive::Message::kSetLimits:
      require(frame.length == 8 && numberAt(frame, 0) > 0.0F && numberAt(frame, 0) <= kSpeedLimit);
      require(numberAt(frame, 4) >= 0.0F && numberAt(frame, 4) <= 20.0F);
      break;
    case odrive::Message::kClearErrors: require(frame.length == 1 && frame.data[0] == 0); break;
    default: require(false);
  }
}

CanFrame takeFrame(Input& input) {
  CanFrame frame;
  const auto head = input.take<std::uint32_t>();
  // Mostly their own nodes.
  frame.id = {(head & 0x1FU) | ((head & 0x20U) != 0 ? 3U << 5U : 62U << 5U), (head & 0x1000U) != 0};
  frame.fd = (head & 0x2000U) != 0;
  frame.type = (head & 0x4000U) != 0 ? FrameType::kRemote : FrameType::kData;
  const auto odd = static_cast<std::uint8_t>((head >> 16U) & 0x3FU);
  frame.length = odd < 48 ? std::uint8_t{8} : static_cast<std::uint8_t>(odd - 48U);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  return frame;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto geared = test::odriveSettings("ODrive_S1", 3);
  geared.gear_ratio = 3.0;
  geared.direction = -1;
  auto old = test::odriveSettings("ODrive_v3", 62);
  old.command_divider = 3;
  const std::array<std::unique_ptr<ODrive_Motor>, 2> motors{test::odriveMotor(geared),
                                                            test::odriveMotor(old)};
  const std::array<int, 2> nodes{3, 62};

  Input input(data, size);
  Tick tick{.now = MonotonicTime{std::chrono::hours{1}}};
  while (!input.empty()) {
    const auto action = input.take<std::uint8_t>();
    ODrive_Motor& motor = *motors[action % motors.size()];
    if (!fuzz::giveOrder(motor, input, action >> 1U)) {
      CanFrame frame = takeFrame(input);
      frame.received = tick.now;
      for (const auto& each : motors) {
        if (each->matchesFrame(frame)) (void)each->updateFeedback(frame);
      }
    }
    ++tick.index;
    tick.now += std::chrono::milliseconds{1 + action};
    for (std::size_t i = 0; i < motors.size(); ++i) {
      motors[i]->update(tick);
      checkReadings(*motors[i]);
      (void)motors[i]->complaint();
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      const auto count = motors[i]->packCommand(tick, out);
      require(count <= out.size());
      for (std::size_t k = 0; k < count; ++k) checkFrame(out[k], nodes[i], motors[i]->ordered());
      require(motors[i]->packRest(out) == 2);
      checkFrame(out[0], nodes[i], FrameKind::kRest);
      checkFrame(out[1], nodes[i], FrameKind::kRest);
    }
  }
  return 0;
}
