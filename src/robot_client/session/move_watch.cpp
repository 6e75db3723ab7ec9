#include "robot_client/session/move_watch.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "app/angle.hpp"
#include "robot_client/session/event_codes.hpp"
#include "robot_client/session/obstacle.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

// For the target on its way to the motor, at the start and after it has lapsed.
constexpr Duration kTargetOnItsWay = milliseconds{300};
// Passing through the tolerance is not arriving.
constexpr std::int64_t kSettledUs = 60'000;
constexpr Duration kSilence = milliseconds{1000};

[[nodiscard]] std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

}  // namespace

MoveResult MoveWatch::failed(std::string reason) const {
  return {MoveResult::Outcome::kFailed, std::move(reason), angle_deg_};
}

double MoveWatch::distance() const {
  if (goal_.mode == Mode::kAngle) return std::abs(shortestAngle(angle_deg_, goal_.target_deg));
  return std::abs(angle_deg_ - goal_.target_deg);
}

void MoveWatch::onEvent(const Event& event) {
  const bool of_us = event.text.find('\'' + client_ + '\'') != std::string::npos;
  const bool of_motor = event.source == goal_.motor;
  if ((of_motor && event.code == kSetpointSkipped) ||
      (of_us && ((of_motor && event.code == kNotOwner) || event.code == kCommandRefused))) {
    refusal_ = event.text;
  }
}

std::optional<std::string> MoveWatch::notObeyed(const MotorState& motor) const {
  if (motor.mode == goal_.mode && motor.target == goal_.target_deg && motor.owner == client_) {
    return std::nullopt;
  }
  const std::string said = refusal_.empty() ? "" : ": " + refusal_;
  if (motor.owner == client_) {
    return motor.name + " follows another target of '" + client_ +
           "': does a second program run under this client name?" + said;
  }
  if (!motor.owner.empty()) {
    return motor.name + " is held by the client '" + motor.owner +
           "': end that one, or take a higher priority" + said;
  }
  if (!refusal_.empty()) return motor.name + " did not take the target" + said;
  const char* const what = obeyed_ > started_ ? " lost the target" : " did not take the target";
  return motor.name + what + ": see `rc10ctl stats` for what was refused";
}

std::optional<MoveResult> MoveWatch::onState(const RobotState& state, MonotonicTime now) {
  last_heard_ = now;
  if (state.taken < started_) return onTime(now);
  const auto* motor = state.find(goal_.motor);
  if (motor != nullptr) {
    angle_deg_ = goal_.mode == Mode::kAngle ? motor->angle_deg : motor->total_angle_deg;
  }
  if (auto reason = obstacle(state, goal_.motor, goal_.mode)) return failed(*reason);
  const auto not_obeyed = notObeyed(*motor);
  if (!not_obeyed) obeyed_ = state.taken;
  if (not_obeyed && state.taken > obeyed_ + kTargetOnItsWay) return failed(*not_obeyed);
  if (std::isnan(angle_deg_)) return failed(goal_.motor + ": the drive reports no angle");
  if (not_obeyed || distance() > goal_.tolerance_deg) {
    within_since_us_.reset();
  } else {
    if (!within_since_us_) within_since_us_ = state.mono_us;
    if (state.mono_us - *within_since_us_ >= kSettledUs) {
      return MoveResult{MoveResult::Outcome::kDone, {}, angle_deg_};
    }
  }
  return onTime(now);
}

std::optional<MoveResult> MoveWatch::onTime(MonotonicTime now) const {
  if (now >= deadline()) {
    return MoveResult{MoveResult::Outcome::kTimeout,
                      goal_.motor + " is at " + number(angle_deg_) + " deg and not at " +
                          number(goal_.target_deg) + " after " +
                          number(std::chrono::duration<double>(goal_.timeout).count()) + " s",
                      angle_deg_};
  }
  if (now >= last_heard_ + kSilence) {
    return failed("no state of the robot for a second: did rc10d or rc10-lcm end?");
  }
  return std::nullopt;
}

}  // namespace robot_client
}  // namespace rc10
