#include "drives/odrive/odrive_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bus/byte_order.hpp"

namespace rc10::odrive {
namespace {

constexpr std::int32_t kPassthrough = 1;
constexpr float kFeedForwardsPerUnit = 1000.0F;
constexpr std::size_t kReplyLength = 8;

std::int16_t feedForward(float value) noexcept {
  if (std::isnan(value)) return 0;
  return static_cast<std::int16_t>(
      std::lround(std::clamp(value * kFeedForwardsPerUnit, -32767.0F, 32767.0F)));
}

CanFrame make(int node, Message message, std::span<const std::uint8_t> payload) noexcept {
  return makeClassicFrame(canId(node, message), payload);
}

template <typename First, typename Second>
CanFrame makePair(int node, Message message, First first, Second second) noexcept {
  std::array<std::uint8_t, 8> payload{};
  writeLittleEndian(std::span<std::uint8_t>{payload}, 0, first);
  writeLittleEndian(std::span<std::uint8_t>{payload}, 4, second);
  return make(node, message, payload);
}

template <typename Value>
CanFrame makeOne(int node, Message message, Value value) noexcept {
  std::array<std::uint8_t, 4> payload{};
  writeLittleEndian(std::span<std::uint8_t>{payload}, 0, value);
  return make(node, message, payload);
}

bool isReply(const CanFrame& frame) noexcept {
  return frame.type == FrameType::kData && !frame.fd && frame.length == kReplyLength;
}

}  // namespace

// Four bytes, as the vendor's documentation counts them; its own ROS node pads to eight, and both firmwares
// read only these four.
CanFrame setAxisState(int node, AxisState state) noexcept {
  return makeOne(node, Message::kSetAxisState, static_cast<std::uint32_t>(state));
}

CanFrame setControllerMode(int node, ControlMode mode) noexcept {
  return makePair(node, Message::kSetControllerMode, static_cast<std::int32_t>(mode), kPassthrough);
}

CanFrame setInputPos(int node, float turns, float velocity_ff, float torque_ff) noexcept {
  std::array<std::uint8_t, 8> payload{};
  const std::span<std::uint8_t> bytes{payload};
  writeLittleEndian(bytes, 0, turns);
  writeLittleEndian(bytes, 4, feedForward(velocity_ff));
  writeLittleEndian(bytes, 6, feedForward(torque_ff));
  return make(node, Message::kSetInputPos, payload);
}

CanFrame setInputVel(int node, float turns_per_s, float torque_ff) noexcept {
  return makePair(node, Message::kSetInputVel, turns_per_s, torque_ff);
}

CanFrame setInputTorque(int node, float torque) noexcept {
  return makeOne(node, Message::kSetInputTorque, torque);
}

CanFrame setLimits(int node, float turns_per_s, float current_a) noexcept {
  return makePair(node, Message::kSetLimits, turns_per_s, current_a);
}

// Firmware 0.6 reads a byte "identify" (blink); 0.5 reads nothing.
CanFrame clearErrors(int node) noexcept {
  constexpr std::array<std::uint8_t, 1> kDoNotBlink{0};
  return make(node, Message::kClearErrors, kDoNotBlink);
}

std::optional<Heartbeat> decodeHeartbeat(const CanFrame& frame) noexcept {
  if (!isReply(frame)) return std::nullopt;
  return Heartbeat{.axis_error = readLittleEndian<std::uint32_t>(frame.payload(), 0),
                   .state = static_cast<AxisState>(frame.data[4]),
                   .byte5 = frame.data[5],
                   .byte6 = frame.data[6],
                   .byte7 = frame.data[7]};
}

std::optional<Pair> decodePair(const CanFrame& frame) noexcept {
  if (!isReply(frame)) return std::nullopt;
  return Pair{.first = readLittleEndian<float>(frame.payload(), 0),
              .second = readLittleEndian<float>(frame.payload(), 4)};
}

}  // namespace rc10::odrive
