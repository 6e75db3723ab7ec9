#include "module/joint_homing.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// Share of the homing velocity: slower than this it stands still.
constexpr double kStill = 0.1;
// The full current pushes until this part of the velocity is missing.
constexpr double kFullPush = 0.5;
// The full push would throw a light axis beyond the velocity from one sample of slow feedback to the next. A
// phase begins with a share of it, which grows from sample to sample while the axis is slow and gets no
// faster, and is halved when it overshoots. At 1 kHz all of it is there after 11 ms. The factors are those
// that homed most of 22 axes at 20 to 1000 Hz, late by up to 20 ms, with the least overshoot.
constexpr double kFirstShare = 0.1;
constexpr double kLeastShare = 0.02;
constexpr double kGrows = 1.25;
constexpr double kResistsMore = 1.15;
// Shares of the velocity that is wanted: beyond or short of it by so much,
constexpr double kFarOff = 0.5;
// and gained or lost within a sample.
constexpr double kGains = 0.1;
// Share of the homing current: as much must be measured at the stop. Drives are some percent off.
constexpr double kPressed = 0.7;
// Share of the homing velocity, on the second way.
constexpr double kSlower = 0.5;
// A current that is slewed, or comes softly after enabling, is waited for as long as it rises by this share
// within this time.
constexpr double kRises = 0.01;
constexpr Duration kPatience = std::chrono::seconds{1};

}  // namespace

void JointHoming::start(const Measured& measured) noexcept {
  start_deg_ = measured.total_angle_deg;
  started_ = measured.now;
  current_a_ = 0.0;
  went_away_ = false;
  begin(Phase::kAway, measured);
  // A load that was held is not dropped.
  share_ = std::min(std::max(kFirstShare, std::fabs(measured.current_a) / config_.current_a), 1.0);
}

void JointHoming::begin(Phase phase, const Measured& measured) noexcept {
  phase_ = phase;
  left_deg_ = still_deg_ = measured.total_angle_deg;
  moved_ = rose_ = measured.received;
  most_a_ = 0.0;
  share_ = std::min(share_, kFirstShare);
  pushed_ = measured.received;
  pushed_rpm_ = measured.velocity_rpm;
}

JointHoming::Progress JointHoming::step(const Measured& measured) noexcept {
  const bool blind = config_.way == Way::kSwitch && !measured.switch_heard;
  if (measured.now - started_ >= config_.timeout || !std::isfinite(measured.total_angle_deg) || blind)
    return end(Progress::kFailed);
  const bool away = phase_ == Phase::kAway || phase_ == Phase::kBackOff;
  return away ? goAway(measured) : goTowards(measured);
}

JointHoming::Progress JointHoming::end(Progress outcome) noexcept {
  current_a_ = 0.0;
  return outcome;
}

JointHoming::Progress JointHoming::goAway(const Measured& measured) noexcept {
  const double gone_deg = towards(measured.total_angle_deg, left_deg_);
  if (gone_deg >= config_.away_deg && !measured.at_switch) {
    went_away_ = true;
    begin(phase_ == Phase::kAway ? Phase::kTowards : Phase::kAgain, measured);
    return goTowards(measured);
  }
  // A switch that stays closed, or an axis that has come loose.
  if (gone_deg > config_.travel_deg + config_.away_deg) return end(Progress::kFailed);
  if (standstill(measured, -1.0) != Standstill::kNone) {
    // It began at its far end: whether it moves at all is seen on the way towards.
    if (phase_ != Phase::kAway || measured.at_switch) return end(Progress::kFailed);
    begin(Phase::kTowards, measured);
    return goTowards(measured);
  }
  push(-velocityRpm(measured), measured);
  return Progress::kUnderWay;
}

JointHoming::Progress JointHoming::goTowards(const Measured& measured) noexcept {
  const bool moves = went_away_ || towards(start_deg_, measured.total_angle_deg) >= config_.away_deg;
  if (towards(start_deg_, measured.total_angle_deg) > config_.travel_deg + config_.away_deg)
    return end(Progress::kNoStop);
  const auto still = standstill(measured, 1.0);
  if (still != Standstill::kNone && !moves) return end(Progress::kFailed);
  if (still == Standstill::kGivenUp) return end(Progress::kNoStop);
  if (config_.way == Way::kSwitch) {
    if (measured.at_switch) return meet(measured);
    if (still == Standstill::kPressed) return end(Progress::kNoStop);
  } else if (still == Standstill::kPressed) {
    const bool nearer = towards(start_deg_, measured.total_angle_deg) < -config_.tolerance_deg;
    return nearer ? end(Progress::kNoStop) : meet(measured);
  }
  push((phase_ == Phase::kAgain ? kSlower : 1.0) * velocityRpm(measured), measured);
  return Progress::kUnderWay;
}

JointHoming::Progress JointHoming::meet(const Measured& measured) noexcept {
  const double here_deg = measured.total_angle_deg;
  if (phase_ == Phase::kAgain) {
    const bool twice = std::fabs(here_deg - met_deg_) <= config_.tolerance_deg;
    return end(twice ? Progress::kFound : Progress::kNoStop);
  }
  met_deg_ = here_deg;
  begin(Phase::kBackOff, measured);
  push(-velocityRpm(measured), measured);
  return Progress::kUnderWay;
}

void JointHoming::push(double velocity_rpm, const Measured& measured) noexcept {
  const double sign = std::copysign(1.0, velocity_rpm);
  const double missing = sign * (velocity_rpm - measured.velocity_rpm) / std::fabs(velocity_rpm);
  if (measured.received != pushed_) {
    const double gained = sign * (measured.velocity_rpm - pushed_rpm_) / std::fabs(velocity_rpm);
    adapt(missing, gained, sign * current_a_);
    pushed_ = measured.received;
    pushed_rpm_ = measured.velocity_rpm;
  }
  const double push = std::clamp(missing / kFullPush, -1.0, 1.0);
  current_a_ = std::isfinite(missing) ? sign * push * share_ * config_.current_a : 0.0;
}

// By what the current of the last sample has done: all as shares of the velocity that is wanted.
void JointHoming::adapt(double missing, double gained, double pushed_a) noexcept {
  const bool slow = missing > kFarOff;
  const bool fast = missing < -kFarOff;
  const bool turned_round = missing > 1.0 + kFarOff;
  if ((fast && pushed_a > 0.0) || (turned_round && pushed_a < 0.0)) {
    share_ /= 2.0;
  } else if ((missing > 1.0 + kGains && gained < -kGains) || (fast && gained >= 0.0)) {
    share_ *= kResistsMore;  // a load drives it
  } else if (slow && pushed_a >= 0.0 && gained < kGains) {
    share_ *= kGrows;
  }
  share_ = std::clamp(share_, kLeastShare, 1.0);
}

// By samples, so that neither a gap of the feedback nor a pause of the process is a standstill.
JointHoming::Standstill JointHoming::standstill(const Measured& measured, double direction) noexcept {
  const bool fast = std::fabs(measured.velocity_rpm) > kStill * std::fabs(velocityRpm(measured));
  const double way_deg = std::fabs(measured.total_angle_deg - still_deg_);
  const double pushed_a =
      direction * std::copysign(measured.current_a, measured.current_a * config_.velocity_rpm);
  const bool rises = pushed_a > most_a_ + kRises * config_.current_a;
  if (fast || way_deg > config_.tolerance_deg) {
    moved_ = rose_ = measured.received;
    still_deg_ = measured.total_angle_deg;
    most_a_ = 0.0;
  } else if (rises) {
    rose_ = measured.received;
    most_a_ = pushed_a;
  }
  if (measured.received - moved_ < config_.stopped) return Standstill::kNone;
  if (pushed_a >= kPressed * config_.current_a) return Standstill::kPressed;  // NaN never is
  return measured.received - rose_ >= config_.stopped + kPatience ? Standstill::kGivenUp : Standstill::kNone;
}

double JointHoming::velocityRpm(const Measured& measured) const noexcept {
  return std::clamp(config_.velocity_rpm, -measured.speed_ceiling_rpm, measured.speed_ceiling_rpm);
}

double JointHoming::towards(double from_deg, double to_deg) const noexcept {
  return (to_deg - from_deg) * std::copysign(1.0, config_.velocity_rpm);
}

}  // namespace rc10
