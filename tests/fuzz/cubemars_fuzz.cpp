// Arbitrary frames, orders and targets to AK motors of all three protocols: whatever comes, readings stay
// finite, angles in [0, 360), efforts within their limits and every frame is one that the drive has.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../support/cubemars_settings.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr float kLimitA = 4.0F;

MotorSettings settingsOf(const char* model, const char* protocol, int id, const char* basis) {
  auto settings = test::cubemarsSettings(
      model, id, {{"protocol", std::string{protocol}}, {"position_basis", std::string{basis}}});
  settings.effort_limit = kLimitA;
  settings.direction = id % 2 == 0 ? -1 : 1;
  settings.gear_ratio = id % 2 == 0 ? 18.0 : 0.0;
  settings.velocity_limit_rpm = id % 3 == 0 ? 50.0F : 0.0F;
  settings.command_divider = id;
  require(cubemarsFamily().check(settings).has_value());
  return settings;
}

struct Entry {
  int id = 0;
  std::unique_ptr<SoloMotor> motor;
};

std::vector<Entry> makeMotors() {
  std::vector<Entry> motors;
  const auto add = [&motors](const MotorSettings& settings) {
    const auto setup = test::setupOf(settings);
    std::unique_ptr<SoloMotor> motor;
    if (setup.protocol == CubemarsProtocol::kServo) {
      motor = std::make_unique<CubemarsServo>(settings, setup);
    } else {
      motor = std::make_unique<CubemarsMit>(settings, setup);
    }
    motors.push_back({settings.id, std::move(motor)});
  };
  add(settingsOf("AK80-9", "servo", 1, "output"));
  add(settingsOf("AK70-10", "servo", 2, "electrical"));
  add(settingsOf("AK80-9", "mit", 3, "output"));
  add(settingsOf("AK60-6", "mit", 4, "output"));
  add(settingsOf("AK80-8-V3", "mit_v3", 5, "output"));
  add(settingsOf("AK10-9-V3", "mit_v3", 6, "rotor"));
  return motors;
}

void checkFrame(const CanFrame& frame, const Entry& entry) {
  require(frame.type == FrameType::kData && !frame.fd && !frame.bit_rate_switch);
  require(frame.length == 4 || frame.length == 8);
  if (frame.id.extended) {
    const auto command = frame.id.value >> 8U;
    require((frame.id.value & 0xFFU) == static_cast<unsigned>(entry.id));
    require(command <= 8 && command != 5 && command != 7);  // 5 would move the origin, perhaps in flash
    require(frame.length == (command >= 6 ? 8 : 4));
    if (command == 1 || command == 2) {
      const auto raw =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(frame.data[0]) << 24U |
                                    static_cast<std::uint32_t>(frame.data[1]) << 16U |
                                    static_cast<std::uint32_t>(frame.data[2]) << 8U | frame.data[3]);
      require(std::abs(raw) <= 4000);
    }
  } else {
    require(frame.id.value == static_cast<unsigned>(entry.id) && frame.length == 8);
    bool special = true;
    for (std::size_t i = 0; i < 7; ++i) special = special && frame.data[i] == 0xFF;
    require(!special || frame.data[7] == 0xFC || frame.data[7] == 0xFD);
  }
}

void checkMotor(const SoloMotor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  require(std::isfinite(motor.commandValue()));
  if (motor.commandUnit() == CommandUnit::kAmpere)
    require(std::abs(motor.commandValue()) <= kLimitA * 1.001F);
  if (feedback.samples == 0) return;
  require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  require(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.velocity_rpm));
}

CanFrame takeFrame(Input& input) {
  CanFrame frame;
  const auto head = input.take<std::uint32_t>();
  const std::uint32_t id = 1 + head % 6U;
  frame.id = (head & 0x100U) != 0 ? CanId{0x2900U + id, true} : CanId{(head & 0x200U) != 0 ? id : 0U, false};
  frame.fd = (head & 0xF000U) == 0x1000U;
  frame.type = (head & 0xF000U) == 0x2000U ? FrameType::kRemote : FrameType::kData;
  const auto odd = static_cast<std::uint8_t>((head >> 16U) & 0x3FU);
  frame.length = odd < 48 ? std::uint8_t{8} : static_cast<std::uint8_t>(odd & 7U);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  if (!frame.id.extended && (head & 0x400U) != 0) frame.data[0] = static_cast<std::uint8_t>(id);
  return frame;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto motors = makeMotors();
  Input input(data, size);
  MonotonicTime now{std::chrono::hours{1}};
  Tick tick;
  while (!input.empty()) {
    const auto action = input.take<std::uint8_t>();
    auto& chosen = *motors[action % motors.size()].motor;
    if (!fuzz::giveOrder(chosen, input, action >> 3U)) {
      CanFrame frame = takeFrame(input);
      frame.received = now += Duration{input.take<std::int32_t>()};
      for (auto& entry : motors) {
        if (entry.motor->matchesFrame(frame)) (void)entry.motor->updateFeedback(frame);
      }
    }
    ++tick.index;
    tick.now = now;
    for (auto& entry : motors) {
      entry.motor->update(tick);
      checkMotor(*entry.motor);
      (void)entry.motor->complaint();
      (void)entry.motor->sequenceProgress();
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      auto count = entry.motor->packCommand(tick, out);
      require(count <= out.size());
      for (std::size_t i = 0; i < count; ++i) checkFrame(out[i], entry);
      count = entry.motor->packRest(out);
      require(count >= 1 && count <= 2);
      for (std::size_t i = 0; i < count; ++i) checkFrame(out[i], entry);
    }
  }
  return 0;
}
