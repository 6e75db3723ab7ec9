// Arbitrary frames, orders and targets to a LK-Tech motor: whatever comes, readings stay finite, angles in
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
#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_motor.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr std::array<std::uint8_t, 9> kCodes{0x92, 0x9A, 0x9B, 0x9C, 0xA1, 0xA2, 0xA4, 0x80, 0x88};
constexpr float kLimitA = 2.5F;
constexpr int kLimitRaw = 311;  // at 33/4096 A each, rounded up

std::unique_ptr<LKTech_Motor> makeMotor(std::uint8_t variation) {
  MotorSettings settings;
  settings.name = "motor";
  settings.model = (variation & 1U) != 0 ? "LK-MG5010E-i10" : "LK-MF9025";
  settings.id = 1;
  settings.direction = (variation & 2U) != 0 ? -1 : 1;
  settings.gear_ratio = (variation & 4U) != 0 ? 18.0 : 0.0;
  settings.effort_limit = kLimitA;
  settings.velocity_limit_rpm = (variation & 8U) != 0 ? 100.0F : 0.0F;
  settings.own = test::ownDefaults(lktechFamily());
  settings.own.set("group", (variation & 16U) != 0 ? 1.0 : 0.0);
  settings.own.set("encoder_bits", (variation & 32U) != 0 ? 14.0 : 16.0);
  return std::make_unique<LKTech_Motor>(settings, lktechFamily().traits(settings.model, settings.own));
}

CanFrame takeFrame(Input& input) {
  const auto head = input.take<std::uint32_t>();
  CanFrame frame;
  frame.id = {0x141U, false};
  frame.sent_here = (head & 1U) != 0;
  frame.type = (head & 0xFEU) == 0 ? FrameType::kRemote : FrameType::kData;
  frame.fd = (head & 0xFF00U) == 0;
  const auto length = static_cast<std::uint8_t>(head >> 16U & 0x1FU);
  frame.length = length < 9 ? length : std::uint8_t{8};
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  frame.data[0] = kCodes[frame.data[0] % kCodes.size()];
  return frame;
}

void checkSent(const CanFrame& frame) {
  require(frame.length == 8 && !frame.fd && !frame.id.extended);
  require(frame.id.value == 0x141U);
  switch (frame.data[0]) {
    case 0x88:
    case 0x92:
    case 0x9A:
    case 0x9B:
    case 0xA4: return;
    case 0xA1: return require(std::abs(readLittleEndian<std::int16_t>(frame.payload(), 4)) <= kLimitRaw);
    case 0xA2: return require(readLittleEndian<std::int16_t>(frame.payload(), 2) <= kLimitRaw);
    default: std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const auto made = makeMotor(input.take<std::uint8_t>());
  const LKTech_Motor& motor = *made;
  fuzz::runAlone(
      *made, input, takeFrame, [&] { require(std::abs(motor.rawCurrent()) <= kLimitRaw); }, checkSent);
  return 0;
}
