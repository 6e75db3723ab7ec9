#include "robot_client/session/held_targets.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <utility>

#include "robot_client/session/event_codes.hpp"
#include "robot_client/session/obstacle.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

// A state that was taken sooner after the target was set may show who held the motor before.
constexpr Duration kClaimOnItsWay = std::chrono::milliseconds{100};
// Lateness of a target that shows a pause of the program: a signal, a busy computer.
constexpr Duration kPause = std::chrono::milliseconds{100};

// One that obeyed all the time has this client's target in force, or on_timeout after it. None of both is
// left when it was enabled anew.
[[nodiscard]] bool enabledAnew(const MotorState& motor, const std::string& client) {
  return motor.owner != client && motor.stop_cause != StopCause::kTimeout;
}

[[nodiscard]] std::optional<std::string> whyDropped(const RobotState& state, const MotorSetpoint& order,
                                                    const std::string& client, MonotonicTime set_at) {
  // It was set because the state before this one spoke for it: this is news.
  if (auto reason = obstacle(state, order.motor, order.setpoint.mode)) return reason;
  const auto& owner = state.find(order.motor)->owner;
  if (owner.empty() || owner == client || state.taken < set_at + kClaimOnItsWay) return std::nullopt;
  return order.motor + " is held by the client '" + owner +
         "', which has the same or a higher priority, or came first";
}

// "ACTIVE -> READY (disabled by 'panel')", "ENABLING -> FAULT".
[[nodiscard]] bool leavesActive(std::string_view change) {
  return change.starts_with("ACTIVE -> ") ||
         (change.starts_with("ENABLING -> ") && !change.starts_with("ENABLING -> ACTIVE"));
}

}  // namespace

void HeldTargets::set(const MotorSetpoints& message, MonotonicTime now, std::int64_t shown_us) {
  alive(now);
  const auto due = resend_ == Duration::zero() ? MonotonicTime::max() : now + resend_;
  Message held{{}, now, now, due, shown_us};
  for (const auto& order : message) {
    release(order.motor);
    if (order.setpoint.mode != Mode::kCoast) held.setpoints.push_back(order);
  }
  if (!held.setpoints.empty()) messages_.push_back(std::move(held));
}

void HeldTargets::release(const std::string& motor) {
  for (auto& message : messages_) {
    std::erase_if(message.setpoints, [&](const auto& order) { return order.motor == motor; });
  }
  std::erase_if(messages_, [](const auto& message) { return message.setpoints.empty(); });
}

bool HeldTargets::holds(const std::string& motor) const {
  return std::any_of(messages_.begin(), messages_.end(), [&](const auto& message) {
    return std::any_of(message.setpoints.begin(), message.setpoints.end(),
                       [&](const auto& order) { return order.motor == motor; });
  });
}

std::vector<std::string> HeldTargets::motors() const {
  std::vector<std::string> names;
  for (const auto& message : messages_) {
    for (const auto& order : message.setpoints) names.push_back(order.motor);
  }
  return names;
}

std::optional<MonotonicTime> HeldTargets::nextDue() const {
  std::optional<MonotonicTime> next;
  for (const auto& message : messages_) next = std::min(next.value_or(message.due), message.due);
  return next;
}

std::vector<MotorSetpoints> HeldTargets::takeDue(MonotonicTime now) {
  std::vector<MotorSetpoints> due;
  for (auto& message : messages_) {
    if (message.due > now) continue;
    // Once it is confirmed it goes out, however late this program is again.
    if (!std::exchange(message.confirmed, false) && now - message.due > kPause) message.resumed = now;
    // On a grid; after a pause from now on, never in a burst.
    message.due = std::max(message.due + resend_, now + resend_ / 2);
    if (message.resumed) continue;
    message.sent = now;
    due.push_back(message.setpoints);
  }
  return due;
}

std::vector<MotorSetpoints> HeldTargets::takeAll(MonotonicTime now) {
  std::vector<MotorSetpoints> all;
  all.reserve(messages_.size());
  for (auto& message : messages_) {
    if (now < message.sent + validity_) all.push_back(std::move(message.setpoints));
  }
  messages_.clear();
  return all;
}

std::vector<HeldTargets::Dropped> HeldTargets::judge(const RobotState& state, const std::string& client) {
  std::vector<Dropped> dropped;
  for (auto& message : messages_) {
    const bool resumes = message.resumed && state.taken >= *message.resumed;
    for (const auto& order : message.setpoints) {
      auto reason = whyDropped(state, order, client, message.set_at);
      if (!reason && resumes && enabledAnew(*state.find(order.motor), client))
        reason = order.motor + " was enabled anew while this program stood still";
      if (reason) dropped.push_back({order.motor, *reason});
    }
    if (resumes) {
      message.resumed.reset();
      message.confirmed = true;
    }
  }
  for (const auto& drop : dropped) release(drop.motor);
  return dropped;
}

std::vector<HeldTargets::Dropped> HeldTargets::judge(const Event& event) {
  std::vector<Dropped> dropped;
  if (event.code != kMotorStatus || !leavesActive(event.text)) return dropped;
  for (const auto& message : messages_) {
    if (event.mono_us <= message.shown_us) continue;
    for (const auto& order : message.setpoints) {
      if (order.motor == event.source) dropped.push_back({order.motor, order.motor + ": " + event.text});
    }
  }
  for (const auto& drop : dropped) release(drop.motor);
  return dropped;
}

std::vector<HeldTargets::Dropped> HeldTargets::lapse(MonotonicTime now) {
  std::vector<Dropped> dropped;
  if (lapse_ == Duration::zero() || now < last_life_ + lapse_) return dropped;
  for (auto& motor : motors()) {
    auto reason =
        motor + " is let go of: the program has neither set a target nor called alive() for too long";
    dropped.push_back({std::move(motor), std::move(reason)});
  }
  releaseAll();
  return dropped;
}

}  // namespace robot_client
}  // namespace rc10
