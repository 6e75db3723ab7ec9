#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/units.hpp"
#include "drives/moteus/moteus_motor.hpp"
#include "motor/sample_spacing.hpp"

// Moteus_Motor: evaluation of its drive's answers.

namespace rc10 {
namespace {

constexpr double kLargestPositionRev = 32768.5;
// More is no reading. The firmware's own servo.max_velocity is 500 rev/s.
constexpr double kLargestRevPerS = 1e5;
constexpr double kLargestTorqueNm = 1e6;

// Its clock has 16 bits here. Over a longer gap it is not compared.
constexpr double kClockRangeMs = 65'536.0;
constexpr double kLongestGapMs = 30'000.0;
constexpr double kClockToleranceMs = 200.0;

// Half a turn and what its speed explains is no jump.
constexpr double kJumpRev = 0.5;
constexpr Duration kLongestStep = std::chrono::milliseconds{100};

[[nodiscard]] double inMilliseconds(Duration duration) noexcept {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

bool Moteus_Motor::decode(const CanFrame& frame, Reading& reading) noexcept {
  moteus::Reader reader(frame.payload());
  moteus::Item item;
  for (;;) {
    const auto step = reader.next(item);
    if (step == moteus::Reader::Step::kEnd) break;
    if (step == moteus::Reader::Step::kMalformed || item.kind != moteus::Item::Kind::kReply) return false;
    switch (item.reg) {
      case moteus::Register::kMode: reading.mode = item.value; break;
      case moteus::Register::kFault: reading.fault = item.value; break;
      case moteus::Register::kPosition:
        reading.position_rev = item.value;
        reading.fine_position = item.type == moteus::Type::kFloat;
        break;
      case moteus::Register::kVelocity: reading.velocity_rev_s = item.value; break;
      case moteus::Register::kTorque: reading.torque_nm = item.value; break;
      case moteus::Register::kQCurrent: reading.current_a = item.value; break;
      case moteus::Register::kVoltage: reading.voltage_v = item.value; break;
      case moteus::Register::kTemperature: reading.temperature_c = item.value; break;
      case moteus::Register::kMilliseconds:
        reading.clock_ms = item.value;
        reading.has_clock = true;
        break;
      case moteus::Register::kRegisterMapVersion: reading.version = item.value; break;
      case moteus::Register::kHomeState: reading.home_state = item.value; break;
      case moteus::Register::kTimeout: reading.timeout_s = item.value; break;
      default: break;
    }
  }
  // An answer to another program's question has other registers or a coarser position.
  if (!reading.fine_position || !reading.has_clock) return false;
  const auto within = [](double value, double most) { return !(std::abs(value) > most); };
  return reading.mode >= 0.0 && reading.mode <= 15.0 && reading.fault >= 0.0 &&
         within(reading.position_rev, kLargestPositionRev) &&
         within(reading.velocity_rev_s, kLargestRevPerS) && within(reading.torque_nm, kLargestTorqueNm);
}

FrameVerdict Moteus_Motor::updateFeedback(const CanFrame& frame) noexcept {
  Reading reading;
  if (!decode(frame, reading)) return FrameVerdict::kMalformed;
  const bool anew = restarted(frame.received, reading.clock_ms);
  answered_ = frame.received;
  takeState(reading);
  if (anew) {
    loseReference();
    if (engaged_) drop(FaultCode::kDriveStopped, static_cast<std::uint32_t>(mode_));
  }
  if (!std::isfinite(reading.position_rev)) return FrameVerdict::kAccepted;  // it has no encoder
  if (jumped(frame.received, reading) && !anew) {
    loseReference();
    ++feedback_.jumps;
  }
  takePosition(reading.position_rev, anew);
  feedback_.velocity_rpm = static_cast<float>(toOutput(reading.velocity_rev_s * kRpmPerTurnPerS));
  feedback_.torque_nm = static_cast<float>(torqueToOutput(reading.torque_nm));
  feedback_.current_a = static_cast<float>(reading.current_a) * direction();
  feedback_.voltage_v = static_cast<float>(reading.voltage_v);
  feedback_.temperature_c = static_cast<float>(reading.temperature_c);
  acceptSample(frame.received, position_rev_ * kDegPerTurn);
  return FrameVerdict::kAccepted;
}

// Its clock counts from power-up, so after a restart it shows no more than the time since its last answer.
// Over a short silence it is a restart only if the clock has not gone on: it goes round each minute.
bool Moteus_Motor::restarted(MonotonicTime received, double clock_ms) noexcept {
  if (!std::isfinite(clock_ms)) return false;  // one value in 65536 reads as "not a number"
  const double before_ms = clock_ms_;
  const auto before = clock_read_;
  clock_ms_ = clock_ms < 0.0 ? clock_ms + kClockRangeMs : clock_ms;
  clock_read_ = received;
  if (!before) return false;
  const double passed_ms = inMilliseconds(received - *before);
  if (passed_ms > kLongestGapMs) return true;
  if (clock_ms_ > passed_ms + kClockToleranceMs) return false;
  const double off_ms = std::remainder(clock_ms_ - before_ms - passed_ms, kClockRangeMs);
  return received - *before > shortestOff() || std::abs(off_ms) > kClockToleranceMs;
}

// A drive is not off for less, nor for a gap of a few answers.
Duration Moteus_Motor::shortestOff() const noexcept { return std::max(kLongestStep, 3 * feedbackPeriod()); }

// Farther than its speed can have taken it: restarted, or its position was set by somebody else.
bool Moteus_Motor::jumped(MonotonicTime received, const Reading& reading) const noexcept {
  // After a silence its own count is right: its clock says whether it was restarted.
  if (feedback_.samples == 0 || received - feedback_.received > kLongestStep) return false;
  const double before_rev_s =
      toDrive(finiteOr0(static_cast<double>(feedback_.velocity_rpm))) / kRpmPerTurnPerS;
  const double fastest_rev_s = std::max(std::abs(reading.velocity_rev_s), std::abs(before_rev_s));
  const auto apart_s =
      static_cast<double>(seconds(longestApart(received - feedback_.received, feedbackPeriod())));
  const double moved_rev = std::remainder(reading.position_rev - (position_rev_ - wire_rev_), kRangeRev);
  return std::abs(moved_rev) > kJumpRev + 1.5 * finiteOr0(fastest_rev_s) * apart_s;
}

void Moteus_Motor::takePosition(double position_rev, bool anew) noexcept {
  if (feedback_.samples == 0 || (anew && traits().absolute)) {
    position_rev_ = position_rev;
  } else if (!anew) {
    position_rev_ += std::remainder(position_rev - (position_rev_ - wire_rev_), kRangeRev);
  }
  wire_rev_ = position_rev_ - position_rev;
}

void Moteus_Motor::takeState(const Reading& reading) noexcept {
  mode_ = static_cast<moteus::Mode>(reading.mode);
  native_fault_ = static_cast<std::uint32_t>(reading.fault);
  if (mode_ != moteus::Mode::kFault) clearing_ = false;
  if (!std::isnan(reading.version)) identity_ = reading;
  if (!std::isnan(reading.timeout_s)) verified_s_ = reading.timeout_s;
  if (!engaged_ || mode_ == moteus::Mode::kPosition || mode_ == moteus::Mode::kBrake) return;
  if (mode_ == moteus::Mode::kFault) {
    engaged_ = false;  // complaint() has the fault
  } else if (mode_ == moteus::Mode::kTimeout) {
    drop(FaultCode::kDriveCommunication, static_cast<std::uint32_t>(mode_));
  } else {
    // After a restart that its clock does not show it counts from elsewhere.
    if (!traits().absolute) loseReference();
    drop(FaultCode::kDriveStopped, static_cast<std::uint32_t>(mode_));
  }
}

void Moteus_Motor::drop(FaultCode why, std::uint32_t native) noexcept {
  engaged_ = false;
  lost_ = {why, native};
}

}  // namespace rc10
