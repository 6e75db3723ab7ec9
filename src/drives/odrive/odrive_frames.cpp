#include "drives/odrive/odrive_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bus/byte_order.hpp"

namespace rc10 {
namespace {

constexpr std::int32_t kPassthrough = 1;
constexpr float kFeedForwardsPerUnit = 1000.0F;
constexpr std::size_t kReplyLength = 8;

std::int16_t feedForward(float value) noexcept {
  if (std::isnan(value)) return 0;
  return static_cast<std::int16_t>(
      std::lround(std::clamp(value * kFeedForwardsPerUnit, -32767.0F, 32767.0F)));
}

CanFrame make(int node, OdriveMessage message, std::span<const std::uint8_t> payload) noexcept {
  return makeClassicFrame(odriveId(node, message), payload);
}

template <typename First, typename Second>
CanFrame makePair(int node, OdriveMessage message, First first, Second second) noexcept {
  std::array<std::uint8_t, 8> payload{};
  writeLittleEndian(std::span<std::uint8_t>{payload}, 0, first);
  writeLittleEndian(std::span<std::uint8_t>{payload}, 4, second);
  return make(node, message, payload);
}

template <typename Value>
CanFrame makeOne(int node, OdriveMessage message, Value value) noexcept {
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
CanFrame odriveSetAxisState(int node, OdriveAxisState state) noexcept {
  return makeOne(node, OdriveMessage::kSetAxisState, static_cast<std::uint32_t>(state));
}

CanFrame odriveSetControllerMode(int node, OdriveControlMode mode) noexcept {
  return makePair(node, OdriveMessage::kSetControllerMode, static_cast<std::int32_t>(mode), kPassthrough);
}

CanFrame odriveSetInputPos(int node, float turns, float velocity_ff, float torque_ff) noexcept {
  std::array<std::uint8_t, 8> payload{};
  const std::span<std::uint8_t> bytes{payload};
  writeLittleEndian(bytes, 0, turns);
  writeLittleEndian(bytes, 4, feedForward(velocity_ff));
  writeLittleEndian(bytes, 6, feedForward(torque_ff));
  return make(node, OdriveMessage::kSetInputPos, payload);
}

CanFrame odriveSetInputVel(int node, float turns_per_s, float torque_ff) noexcept {
  return makePair(node, OdriveMessage::kSetInputVel, turns_per_s, torque_ff);
}

CanFrame odriveSetInputTorque(int node, float torque) noexcept {
  return makeOne(node, OdriveMessage::kSetInputTorque, torque);
}

CanFrame odriveSetLimits(int node, float turns_per_s, float current_a) noexcept {
  return makePair(node, OdriveMessage::kSetLimits, turns_per_s, current_a);
}

// Firmware 0.6 reads a byte "identify" (blink); 0.5 reads nothing.
CanFrame odriveClearErrors(int node) noexcept {
  constexpr std::array<std::uint8_t, 1> kDoNotBlink{0};
  return make(node, OdriveMessage::kClearErrors, kDoNotBlink);
}

std::optional<OdriveHeartbeat> decodeOdriveHeartbeat(const CanFrame& frame) noexcept {
  if (!isReply(frame)) return std::nullopt;
  return OdriveHeartbeat{.axis_error = readLittleEndian<std::uint32_t>(frame.payload(), 0),
                         .state = static_cast<OdriveAxisState>(frame.data[4]),
                         .byte5 = frame.data[5],
                         .byte6 = frame.data[6],
                         .byte7 = frame.data[7]};
}

std::optional<OdrivePair> decodeOdrivePair(const CanFrame& frame) noexcept {
  if (!isReply(frame)) return std::nullopt;
  return OdrivePair{.first = readLittleEndian<float>(frame.payload(), 0),
                    .second = readLittleEndian<float>(frame.payload(), 4)};
}

}  // namespace rc10
