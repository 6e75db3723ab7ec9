// Arbitrary frames, orders and targets to a MyActuator motor: whatever comes, readings stay finite, angles in
// [0, 360), and only valid frames with the drive's own ids leave, none of which writes to its memory.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "../support/own_defaults.hpp"
#include "bus/byte_order.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr std::array<std::uint8_t, 10> kCodes{0x92, 0x9A, 0x9C, 0xA1, 0xA2, 0xA4, 0xB1, 0xF1, 0x77, 0x80};
constexpr float kLimitA = 2.5F;

std::unique_ptr<MyActuator_Motor> makeMotor(std::uint8_t variation) {
  MotorSettings settings;
  settings.name = "motor";
  settings.model = (variation & 1U) != 0 ? "RMD-X8-25" : "RMD-X";
  settings.id = 1;
  settings.direction = (variation & 2U) != 0 ? -1 : 1;
  settings.gear_ratio = (variation & 4U) != 0 ? 18.0 : 0.0;
  settings.effort_limit = kLimitA;
  settings.velocity_limit_rpm = (variation & 8U) != 0 ? 100.0F : 0.0F;
  settings.own = test::ownDefaults(myactuatorFamily());
  settings.own.set("release_brake", (variation & 16U) != 0 ? 1.0 : 0.0);
  settings.own.set("absolute_encoder", (variation & 32U) != 0 ? 1.0 : 0.0);
  return std::make_unique<MyActuator_Motor>(settings,
                                            myactuatorFamily().traits(settings.model, settings.own));
}

CanFrame takeFrame(Input& input) {
  const auto head = input.take<std::uint32_t>();
  CanFrame frame;
  frame.id = {(head & 1U) != 0 ? 0x501U : 0x241U, false};
  frame.type = (head & 0xFEU) == 0 ? FrameType::kRemote : FrameType::kData;
  frame.fd = (head & 0xFF00U) == 0;
  const auto length = static_cast<std::uint8_t>(head >> 16U & 0x1FU);
  frame.length = length < 9 ? length : std::uint8_t{8};
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  if (frame.id.value == 0x241U) frame.data[0] = kCodes[frame.data[0] % kCodes.size()];
  return frame;
}

void checkSent(const CanFrame& frame) {
  require(frame.length == 8 && !frame.fd && !frame.id.extended);
  if (frame.id.value == 0x401U) return;
  require(frame.id.value == 0x141U);
  switch (frame.data[0]) {
    case 0x76:
    case 0x77:
    case 0x80:
    case 0x92:
    case 0x9A:
    case 0x9C:
    case 0xA2:
    case 0xA4:
    case 0xB1: return;
    case 0xA1: return require(std::abs(readLittleEndian<std::int16_t>(frame.payload(), 4)) <= 250);
    default: std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const auto made = makeMotor(input.take<std::uint8_t>());
  fuzz::runAlone(
      *made, input, takeFrame, [] {}, checkSent);
  return 0;
}
