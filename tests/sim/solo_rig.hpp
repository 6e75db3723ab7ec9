#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "motor/solo_motor.hpp"
#include "sim/drive.hpp"

namespace rc10::test {

/// One motor and its simulated drive, frames handed over without sockets, in virtual time: the tick at whole
/// milliseconds, the drive half a millisecond later.
class SoloRig {
 public:
  SoloRig(std::unique_ptr<SoloMotor> motor, std::unique_ptr<sim::Drive> drive)
      : motor_(std::move(motor)), drive_(std::move(drive)) {}

  [[nodiscard]] SoloMotor& motor() { return *motor_; }
  [[nodiscard]] sim::Drive& drive() { return *drive_; }
  [[nodiscard]] MonotonicTime now() const { return now_; }
  /// Every frame that the motor sent since the last call.
  [[nodiscard]] std::vector<CanFrame> takeSent() { return std::exchange(sent_, {}); }
  /// Every frame that the drive sent since the last call.
  [[nodiscard]] std::vector<CanFrame> takeReceived() { return std::exchange(received_, {}); }
  /// Against a wall: as much torque as there is.
  void stall(bool stalled) {
    auto load = drive_->load();
    load.stalled = stalled;
    drive_->setLoad(load);
  }
  /// Change of each frame on its way from the drive to the motor.
  void garble(std::function<void(CanFrame&)> change) { garble_ = std::move(change); }
  /// Frames of the motor that its drive never gets.
  void lose(std::function<bool(const CanFrame&)> lost) { lost_ = std::move(lost); }
  /// Time that a frame of the drive takes to the motor, in whole ticks.
  void delay(Duration by) { delay_ = by; }
  /// Nothing passes in either direction, from now on.
  void cut(bool cut) { cut_ = cut; }

  /// Polls it until it is heard; for drives that speak when asked.
  void comeOnline() {
    motor_->order(FrameKind::kPoll);
    run(std::chrono::milliseconds{100});
    ASSERT_GT(motor_->feedback().samples, 0U);
  }
  /// The current that flows in its winding.
  [[nodiscard]] double currentA() { return std::fabs(drive_->physics().currentA()); }

  void command(const Target& target) {
    motor_->order(FrameKind::kCommand);
    motor_->setTarget(target);
  }

  /// The enable sequence, as the supervisor runs it, within its time limit. True: the motor says it is done.
  bool enable(Duration patience = std::chrono::seconds{2}) {
    motor_->order(FrameKind::kEnable);
    for (const MonotonicTime end = now_ + patience; now_ < end;) {
      run(std::chrono::milliseconds{1});
      if (motor_->sequenceProgress() == SequenceProgress::kDone) return true;
      if (motor_->sequenceProgress() == SequenceProgress::kFailed) return false;
    }
    return false;
  }

  /// `each_tick` is called when the motor's feedback of a millisecond has arrived.
  void run(Duration duration, const std::function<void()>& each_tick = {}) {
    for (const MonotonicTime end = now_ + duration; now_ < end; now_ += 2 * kHalfPeriod) {
      const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
      motor_->update(tick);
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      const auto count = motor_->packCommand(tick, out);
      for (std::size_t i = 0; i < count; ++i) {
        sent_.push_back(out[i]);
        if (!cut_ && !(lost_ && lost_(out[i]))) drive_->receive(out[i]);
      }
      drive_->step(2 * kHalfPeriod);
      elapsed_ += 2 * kHalfPeriod;
      std::array<CanFrame, sim::Drive::kMaxFrames> in{};
      deliver(in, drive_->answers(in));
      const auto period = drive_->feedbackPeriod();
      if (period > Duration::zero() && elapsed_ >= next_feedback_) {
        next_feedback_ += period;
        deliver(in, drive_->feedback(in));
      }
      if (each_tick) each_tick();
    }
  }

 private:
  static constexpr Duration kHalfPeriod{std::chrono::microseconds{500}};

  void deliver(std::span<CanFrame> frames, std::size_t count) {
    for (auto& frame : frames.first(count)) {
      frame.received = now_ + kHalfPeriod;
      if (garble_) garble_(frame);
      received_.push_back(frame);
      if (!cut_) under_way_.push_back(frame);
    }
    arrive();
  }
  void arrive() {
    const MonotonicTime now = now_ + kHalfPeriod;
    while (!under_way_.empty() && under_way_.front().received + delay_ <= now) {
      CanFrame frame = under_way_.front();
      under_way_.pop_front();
      frame.received = now;
      if (motor_->matchesFrame(frame)) (void)motor_->updateFeedback(frame);
    }
  }

  std::unique_ptr<SoloMotor> motor_;
  std::unique_ptr<sim::Drive> drive_;
  std::vector<CanFrame> sent_;
  std::vector<CanFrame> received_;
  std::deque<CanFrame> under_way_;
  std::function<bool(const CanFrame&)> lost_;
  std::function<void(CanFrame&)> garble_;
  MonotonicTime now_{std::chrono::hours{1}};
  std::uint64_t ticks_ = 0;
  Duration elapsed_{};
  Duration delay_{};
  Duration next_feedback_{};
  bool cut_ = false;
};

/// A drive that obeys has no torque soon after an order for none.
template <typename MakeRig>
void expectNoTorqueAtRestAndPoll(MakeRig makeRig, const Target& before) {
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll}) {
    SoloRig rig = makeRig();
    rig.comeOnline();
    ASSERT_TRUE(rig.enable());
    rig.command(before);
    rig.run(std::chrono::milliseconds{300});
    ASSERT_GT(std::abs(rig.drive().physics().outputRpm()), 1.0) << "it obeyed before";
    rig.stall(true);
    rig.run(std::chrono::milliseconds{50});
    ASSERT_GT(rig.currentA(), 0.2);
    rig.motor().order(kind);
    rig.run(std::chrono::milliseconds{20});
    EXPECT_LT(std::abs(rig.currentA()), 0.02);
  }
}

}  // namespace rc10::test
