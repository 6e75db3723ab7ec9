#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drives/damiao/damiao_family.hpp"
#include "drives/damiao/damiao_motor.hpp"

namespace rc10::test {

/// As the configuration would give it, defaults filled in.
inline MotorSettings damiaoSettingsOf(const std::string& model = "DM4310", const std::string& control = "mit",
                                      int id = 1) {
  MotorSettings settings;
  settings.name = model + "_" + std::to_string(id);
  settings.model = model;
  settings.id = id;
  settings.own.set("master_id", static_cast<double>(id + 16));
  settings.own.set("control", control);
  settings.own.set("watchdog_ms", 100.0);
  return settings;
}

inline CanFrame damiaoFrame(std::uint32_t id, std::vector<std::uint8_t> payload,
                            MonotonicTime received = {}) {
  CanFrame frame = makeClassicFrame({id, false}, payload);
  frame.received = received;
  return frame;
}

inline std::vector<std::uint8_t> bytesOf(const CanFrame& frame) {
  return {frame.payload().begin(), frame.payload().end()};
}

/// Answers a motor as a drive that stands still would; its fields can be set at will.
class DamiaoDesk {
 public:
  explicit DamiaoDesk(MotorSettings settings)
      : settings_(std::move(settings)), own_(damiaoSettings(settings_)), motor_(settings_) {}

  Damiao_Motor& motor() { return motor_; }
  damiao::State state{.status = 0,
                      .position = 0x8000,
                      .velocity = 0x800,
                      .torque = 0x800,
                      .drive_temperature = 30,
                      .winding_temperature = 31};
  float xout_rad = 0.0F;
  bool answers_registers = true;
  std::array<std::uint32_t, 256> registers{};

  [[nodiscard]] MonotonicTime now() const { return now_; }
  FrameVerdict feed(const damiao::State& told) {
    state = told;
    return give(damiao::writeState(settings_.id, told));
  }
  FrameVerdict give(const damiao::Payload& payload) {
    const CanId id{own_.master_id, false};
    CanFrame frame = own_.can_fd ? makeFdFrame(id, payload, true) : makeClassicFrame(id, payload);
    frame.received = now_;
    EXPECT_TRUE(motor_.matchesFrame(frame));
    return motor_.updateFeedback(frame);
  }
  /// One tick; what the motor sent.
  std::vector<CanFrame> tick(Duration spacing = std::chrono::milliseconds{1}) {
    now_ += spacing;
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_.packCommand(tick, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  /// One tick, answered as an obedient drive does.
  std::vector<CanFrame> tickAnswered() {
    auto sent = tick();
    for (const auto& frame : sent) answer(frame);
    return sent;
  }
  void answerAll(const std::vector<CanFrame>& sent) {
    for (const auto& frame : sent) answer(frame);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) (void)tickAnswered();
  }
  bool enable() {
    motor_.order(FrameKind::kEnable);
    for (int i = 0; i < 500; ++i) {
      (void)tickAnswered();
      if (motor_.sequenceProgress() != SequenceProgress::kPending) break;
    }
    return motor_.sequenceProgress() == SequenceProgress::kDone;
  }
  void command(const Target& target) { motor_.order(FrameKind::kCommand, target); }

 private:
  void answer(const CanFrame& frame) {
    const auto payload = std::span(frame.data).first<8>();
    if (frame.id.value == damiao::kRegisterId) {
      if (answers_registers) answerRegister(payload);
      return;
    }
    if (payload[0] == 0xFF && payload[6] == 0xFF && frame.length == 8) {
      if (payload[7] == 0xFC && state.status == 0) state.status = 1;
      if (payload[7] == 0xFD && state.status == 1) state.status = 0;
      if (payload[7] == 0xFB) state.status = 0;
    }
    (void)feed(state);
  }
  void answerRegister(std::span<const std::uint8_t, 8> payload) {
    const std::uint8_t address = payload[3];
    std::uint32_t value = 0;
    for (std::size_t i = 8; i-- > 4;) value = value << 8U | payload[i];
    if (payload[2] == 0x55) registers[address] = value;
    if (payload[2] == 0x33) {
      value = registers[address];
      if (address == 21 && value == 0) value = damiao::bitsOf(static_cast<float>(own_.scale.p_max_rad));
      if (address == 22 && value == 0) value = damiao::bitsOf(static_cast<float>(own_.scale.v_max_rad_s));
      if (address == 23 && value == 0) value = damiao::bitsOf(static_cast<float>(own_.scale.t_max_nm));
      if (address == 81) value = damiao::bitsOf(xout_rad);
    }
    auto reply = damiao::writeRegister(settings_.id, static_cast<damiao::Register>(address), value);
    reply[2] = payload[2];
    (void)give(reply);
  }

  MotorSettings settings_;
  DamiaoSettings own_;
  Damiao_Motor motor_;
  MonotonicTime now_{std::chrono::seconds{10}};
  std::uint64_t ticks_ = 0;
};

}  // namespace rc10::test
