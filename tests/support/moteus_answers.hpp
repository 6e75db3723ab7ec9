#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drives/moteus/moteus_family.hpp"
#include "drives/moteus/moteus_motor.hpp"
#include "support/moteus_settings.hpp"

namespace rc10::test {

/// A drive's report of itself: an answer to Moteus_Motor's questions.
struct MoteusAnswer {
  moteus::Mode mode = moteus::Mode::kStopped;
  int fault = 0;
  double position_rev = 0.0;
  double velocity_rev_s = 0.0;
  double torque_nm = 0.0;
  double current_a = 0.0;
  double voltage_v = 24.0;
  double temperature_c = 30.0;
  Duration clock_late{};  ///< Lag of its clock behind ours.
  std::optional<int> version{};
  std::optional<double> timeout_s{};
};

[[nodiscard]] inline CanFrame moteusAnswer(const MoteusAnswer& answer, MonotonicTime received,
                                           std::uint32_t id = 1, std::uint32_t prefix = 0) {
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(received.time_since_epoch() - answer.clock_late)
          .count();
  moteus::Writer frame(moteus::replyId(prefix, id), true);
  frame.reply(moteus::Type::kInt8, moteus::Register::kMode, {static_cast<double>(answer.mode)})
      .reply(moteus::Type::kFloat, moteus::Register::kPosition,
             {answer.position_rev, answer.velocity_rev_s, answer.torque_nm})
      .reply(moteus::Type::kInt16, moteus::Register::kQCurrent, {answer.current_a})
      .reply(moteus::Type::kInt8, moteus::Register::kVoltage,
             {answer.voltage_v, answer.temperature_c, static_cast<double>(answer.fault)})
      .reply(moteus::Type::kInt16, moteus::Register::kMilliseconds,
             {static_cast<double>(static_cast<std::int16_t>(ms & 0xFFFF))});
  if (answer.version) {
    frame.reply(moteus::Type::kInt32, moteus::Register::kRegisterMapVersion, {double(*answer.version)})
        .reply(moteus::Type::kInt8, moteus::Register::kHomeState, {1.0});
  }
  if (answer.timeout_s) frame.reply(moteus::Type::kInt16, moteus::Register::kTimeout, {*answer.timeout_s});
  CanFrame out = frame.frame();
  out.received = received;
  return out;
}

/// A motor and its ticks; the test is the drive.
struct MoteusBench {
  explicit MoteusBench(const MotorSettings& settings = moteusMotor())
      : motor(settings, moteusFamily().traits(settings.model, settings.own)), id(settings.id) {}

  /// The drive's answer, then a tick. What was sent in it is in `sent`.
  FrameVerdict answer(const MoteusAnswer& answer) {
    now += std::chrono::milliseconds{1};
    const auto verdict = motor.updateFeedback(moteusAnswer(answer, now, static_cast<std::uint32_t>(id)));
    tick();
    return verdict;
  }
  void tick() {
    ++index;
    const Tick tick{.index = index, .now = now, .dt_s = 0.001F};
    motor.update(tick);
    sent_count = motor.packCommand(tick, frames);
  }
  /// Through the whole sequence, with the drive at this position.
  bool enable(double position_rev = 0.0) {
    motor.order(FrameKind::kEnable);
    tick();
    answer({.position_rev = position_rev, .version = 5});
    answer({.mode = moteus::Mode::kPosition, .position_rev = position_rev});
    answer({.mode = moteus::Mode::kPosition, .position_rev = position_rev, .timeout_s = 0.1});
    return motor.sequenceProgress() == SequenceProgress::kDone;
  }
  bool command(const Target& target, double position_rev = 0.0) {
    motor.order(FrameKind::kCommand);
    const bool taken = motor.setTarget(target);
    answer({.mode = moteus::Mode::kPosition, .position_rev = position_rev});
    return taken;
  }
  /// The value that the sent frame writes to a register; none if it does not write it.
  [[nodiscard]] std::optional<double> written(moteus::Register reg) const {
    if (sent_count == 0) return std::nullopt;
    moteus::Reader reader(frames[0].payload());
    std::optional<double> value;
    for (moteus::Item item; reader.next(item) == moteus::Reader::Step::kItem;) {
      if (item.kind == moteus::Item::Kind::kWrite && item.reg == reg) value = item.value;
    }
    return value;
  }
  [[nodiscard]] std::optional<double> mode() const { return written(moteus::Register::kMode); }

  Moteus_Motor motor;
  int id;
  MonotonicTime now{std::chrono::hours{1}};
  std::uint64_t index = 0;
  std::array<CanFrame, kMaxFramesPerPacker> frames{};
  std::size_t sent_count = 0;
};

}  // namespace rc10::test
