#include <algorithm>
#include <cmath>
#include <limits>

#include "app/angle.hpp"
#include "app/units.hpp"
#include "drives/vesc/vesc_motor.hpp"

// The receiving half of VESC_Motor.
namespace rc10 {
namespace {

using std::chrono::milliseconds;

constexpr double kStepsPerElectricalTurn = 6.0;
constexpr double kSecondsPerMinute = 60.0;
constexpr int kVescGapPeriods = 5;
// A drive that starts is silent for longer (main.c waits 500 ms alone); a cable that is plugged in again may
// be another drive's.
constexpr Duration kRestartGap = milliseconds{300};
// Tolerance of a tachometer step over the one that the speed explains.
constexpr double kStepSlack = 12.0;
constexpr double kErpmPerS = 500'000.0;  // a bare rotor at full current; estimated, generous
constexpr double kAmbiguousDeg = 120.0;
// Stamps are late by less.
constexpr Duration kLatestStamp = milliseconds{2};
// Largest distance of the encoder from where a changing speed can have taken it.
constexpr double kExplainedDeg = 60.0;

}  // namespace

bool VESC_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  if (frame.fd || frame.type != FrameType::kData) return false;
  return std::any_of(filters_.begin(), filters_.end(),
                     [&frame](const FrameFilter& filter) { return accepts(filter, frame); });
}

FrameVerdict VESC_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (!matchesFrame(frame)) return FrameVerdict::kMalformed;
  const auto packet = static_cast<vesc::Packet>(frame.id.value >> 8U);
  if (packet == vesc::Packet::kNotifyBoot) {
    restarted();
    return FrameVerdict::kAccepted;
  }
  if (packet == vesc::Packet::kProcessShortBuffer) {
    const auto answer = vesc::decodeAnswer(frame);
    if (!answer) return FrameVerdict::kMalformed;
    inquiry_.take(*answer);
    return FrameVerdict::kAccepted;
  }
  if (frame.length != vesc::kStatusLength) return FrameVerdict::kMalformed;
  inquiry_.spoke();
  switch (packet) {
    case vesc::Packet::kStatus1: takeStatus1(frame); break;
    case vesc::Packet::kStatus4:
      status4_ = vesc::decodeStatus4(frame);
      feedback_.temperature_c = own_.motor_temperature ? status4_.motor_c : status4_.drive_c;
      if (own_.angle == VescAngle::kEncoder) takeEncoder(frame);
      break;
    case vesc::Packet::kStatus5:
      if (own_.angle == VescAngle::kTachometer) takeSteps(frame);
      status5_ = vesc::decodeStatus5(frame);
      feedback_.voltage_v = status5_.input_v;
      break;
    // Consumption and analogue inputs: signs of life, no feedback of the shaft.
    case vesc::Packet::kStatus2:
    case vesc::Packet::kStatus3:
    case vesc::Packet::kStatus6: break;
    default: return FrameVerdict::kMalformed;
  }
  return FrameVerdict::kAccepted;
}

float VESC_Motor::reportedDuty() const noexcept {
  return status1Fresh(position_at_) ? status1_.duty * direction() : std::numeric_limits<float>::quiet_NaN();
}

bool VESC_Motor::status1Fresh(MonotonicTime now) const noexcept {
  return status1_seen_ && now - status1_at_ <= patience_;
}

void VESC_Motor::takeStatus1(const CanFrame& frame) noexcept {
  const vesc::Status1 status = vesc::decodeStatus1(frame);
  // Every source of the angle has STATUS_1. Firmware before 6.00 does not tell that it has started.
  if (status1_seen_ && gapTooLong(frame.received - status1_at_)) inquiry_.restart();
  status1_ = status;
  status1_at_ = frame.received;
  status1_seen_ = true;
  const double rotor_rpm = static_cast<double>(status.erpm) / own_.pole_pairs;
  feedback_.velocity_rpm = static_cast<float>(rotor_rpm / rotor_per_output_);
  // The sign of the reported current is that of the power: sign(vq * iq). The duty has the sign of vq, so
  // their product has that of iq, the torque. The speed stands in for a duty too small to be told.
  const float way = status.duty != 0.0F ? status.duty : static_cast<float>(status.erpm);
  const float drive_a = way < 0.0F ? -status.current_a : status.current_a;
  feedback_.current_a = drive_a * direction();
  if (torqueNmPerA() > 0.0F) feedback_.torque_nm = feedback_.current_a * torqueNmPerA();
  if (own_.angle != VescAngle::kNone) return;
  feedback_.received = frame.received;
  ++feedback_.samples;
}

bool VESC_Motor::gapTooLong(Duration gap) const noexcept {
  return gap > std::max(kRestartGap, kVescGapPeriods * feedbackPeriod());
}

/// A change of the drive's position; `known`: its number of turns is not in doubt.
void VESC_Motor::takePosition(MonotonicTime received, double moved_deg, bool known) noexcept {
  const Duration gap = received - position_at_;
  spacing_.add(feedback_.samples == 0 ? Duration::zero() : gap);
  position_at_ = received;
  position_deg_ += moved_deg;
  position_seen_ = true;
  // Without STATUS_1 beside it there is no speed and no current, so that no guard sees anything, and turns
  // cannot be counted: it is no feedback.
  const bool guarded = status1Fresh(received);
  if ((!known || !guarded) && feedback_.samples > 0) loseReference();
  if (guarded) acceptSample(received, position_deg_);
}

void VESC_Motor::takeSteps(const CanFrame& frame) noexcept {
  const std::int32_t steps = vesc::decodeStatus5(frame).steps;
  const double deg_per_step = kDegPerTurn / (kStepsPerElectricalTurn * own_.pole_pairs);
  if (!position_seen_) {
    takePosition(frame.received, feedback_.samples == 0 ? steps * deg_per_step : 0.0, false);
    return;
  }
  // Modulo 2^32, as the drive counts.
  const auto moved = static_cast<std::int32_t>(static_cast<std::uint32_t>(steps) -
                                               static_cast<std::uint32_t>(status5_.steps));
  const Duration gap = frame.received - position_at_;
  const auto span_s =
      static_cast<double>(seconds(longestApart(std::min(gap, kRestartGap), feedbackPeriod())));
  const double erpm = std::abs(static_cast<double>(status1_.erpm));
  const double fastest_steps_per_s =
      (erpm + kErpmPerS * span_s) * kStepsPerElectricalTurn / kSecondsPerMinute;
  const bool jumped = std::abs(static_cast<double>(moved)) > kStepSlack + fastest_steps_per_s * span_s;
  const bool doubtful = gapTooLong(gap) || jumped;
  if (jumped && !gapTooLong(gap)) ++feedback_.jumps;
  takePosition(frame.received, doubtful ? 0.0 : moved * deg_per_step, !doubtful);
}

// Where the speed has taken it, then the nearest such angle.
VESC_Motor::Way VESC_Motor::wayOver(double now_deg, Duration spacing) const noexcept {
  const double rotor_rpm = static_cast<double>(status1_.erpm) / own_.pole_pairs;
  const double expected =
      rotor_rpm / own_.position_divider * kDegPerSPerRpm * std::chrono::duration<double>(spacing).count();
  const double off = shortestAngle(position_deg_ + expected, now_deg);
  return {.moved = expected + off, .off = std::abs(off)};
}

// In truth samples lie whole periods apart: the spacing at which speed and angle agree best. Where another
// one explains the angle with another number of turns, it is in doubt.
VESC_Motor::Way VESC_Motor::wayTo(double now_deg, Duration gap) const noexcept {
  const Duration period = feedbackPeriod();
  const auto first = std::max<Duration::rep>(1, (gap - kLatestStamp + period) / period);
  const auto last = (gap + kLatestStamp) / period;
  if (first > last) return wayOver(now_deg, gap);
  Way best = wayOver(now_deg, first * period);
  for (auto periods = first + 1; periods <= last; ++periods) {
    const Way other = wayOver(now_deg, periods * period);
    if (other.off < best.off) best = other;
  }
  for (auto periods = first; periods <= last; ++periods) {
    const Way other = wayOver(now_deg, periods * period);
    const bool other_turn = std::abs(other.moved - best.moved) > kDegPerTurn / 2.0;
    best.doubtful = best.doubtful || (other_turn && other.off <= kExplainedDeg);
  }
  return best;
}

void VESC_Motor::takeEncoder(const CanFrame& frame) noexcept {
  const double now_deg = static_cast<double>(status4_.position_deg);
  if (!position_seen_) {
    const double moved = feedback_.samples == 0 ? now_deg : shortestAngle(position_deg_, now_deg);
    takePosition(frame.received, moved, false);
    return;
  }
  const Duration gap = frame.received - position_at_;
  if (gapTooLong(gap)) return takePosition(frame.received, shortestAngle(position_deg_, now_deg), false);
  const Way way = wayTo(now_deg, std::max(gap, Duration::zero()));
  takePosition(frame.received, way.moved, !way.doubtful && way.off <= kAmbiguousDeg);
}

void VESC_Motor::restarted() noexcept {
  if (obeying()) restarted_ = true;
  inquiry_.restart();
  position_seen_ = false;  // it counts from 0 again
  status1_seen_ = false;
  loseReference();
}

}  // namespace rc10
