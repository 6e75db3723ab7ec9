#include "robot_client/session/session_targets.hpp"

#include <algorithm>

#include "app/message_limits.hpp"
#include "robot_client/session/obstacle.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

[[nodiscard]] std::optional<MonotonicTime> earlier(std::optional<MonotonicTime> a,
                                                   std::optional<MonotonicTime> b) {
  return a && b ? std::min(*a, *b) : a ? a : b;
}

}  // namespace

Result<void> SessionTargets::mayCommand(const MotorSetpoints& setpoints, MonotonicTime now) const {
  if (core_.closed) return fail("the robot is closed");
  if (!core_.newest.get()) {
    return fail("no state of robot '" + core_.name +
                "' has come yet: call waitForState(), which says what to check");
  }
  if (!core_.newest.live(now)) {
    return fail("no state of robot '" + core_.name + "' for a second: rc10d or rc10-lcm has ended, or hangs");
  }
  return checkSetpoints(*core_.believed(), setpoints);
}

std::int64_t SessionTargets::shownUs() const {
  const auto newest = core_.newest.get();
  return newest ? newest->mono_us : 0;
}

Result<void> SessionTargets::publish(const MotorSetpoints& setpoints) {
  core_.leaving.commanded(setpoints);
  return core_.outgoing.command(setpoints, core_.options.validity);
}

Result<void> SessionTargets::command(const MotorSetpoints& setpoints) {
  if (!core_.status) return core_.status;
  const auto now = timeNow();
  News news;
  Result<void> done;
  {
    const SessionCore::Lock lock(core_.mutex);
    done = mayCommand(setpoints, now);
    if (done) {
      moves_.supersede(setpoints, news.moves);
      done = publish(setpoints);
      held_.set(setpoints, now, shownUs());
    }
  }
  core_.wake_sender.notify_all();
  news.tell(core_.problems);
  if (!done) core_.problems.tell(done.error().message);
  return done;
}

std::future<MoveResult> SessionTargets::moveTo(const MoveGoal& goal) {
  const MotorSetpoints setpoints{{goal.motor, goal.mode == Mode::kAngle
                                                  ? Setpoint::angle(Degrees{goal.target_deg})
                                                  : Setpoint::totalAngle(Degrees{goal.target_deg})}};
  const auto now = timeNow();
  MoveWatch watch(goal, core_.options.client, now);
  std::promise<MoveResult> promise;
  auto future = promise.get_future();
  News news;
  {
    const SessionCore::Lock lock(core_.mutex);
    auto possible = core_.status ? mayCommand(setpoints, now) : core_.status;
    if (possible && core_.options.resend == milliseconds{0}) {
      possible = fail("moveTo() needs held targets: RobotOptions::resend is 0");
    }
    if (possible && !(goal.tolerance_deg > 0.0))
      possible = fail("the tolerance of moveTo() has to be above 0");
    if (possible) {
      moves_.supersede(setpoints, news.moves);
      possible = publish(setpoints);
    }
    if (possible) {
      held_.set(setpoints, now, shownUs());
      moves_.start(std::move(watch), std::move(promise));
    } else {
      news.moves.push_back({std::move(promise), watch.failed(possible.error().message)});
    }
  }
  core_.wake_sender.notify_all();
  news.tell(core_.problems);
  return future;
}

void SessionTargets::alive() {
  const SessionCore::Lock lock(core_.mutex);
  aliveAt(timeNow());
}

void SessionTargets::onState(const RobotState& state, MonotonicTime now, News& news) {
  moves_.onState(state, now, news.moves);
  drop(held_.judge(state, core_.options.client), news);
}

void SessionTargets::onEvent(const Event& event, News& news) {
  moves_.onEvent(event);
  drop(held_.judge(event), news);
}

void SessionTargets::release(const std::vector<std::string>& motors) {
  for (const auto& motor : motors) held_.release(motor);
  if (motors.empty()) held_.releaseAll();
}

void SessionTargets::drop(const std::vector<HeldTargets::Dropped>& dropped, News& news) {
  for (const auto& [motor, reason] : dropped) {
    if (core_.options.resend == milliseconds{0}) break;  // the program's own loop decides
    news.problems.push_back("target dropped: " + reason);
    moves_.fail(motor, reason, news.moves);
  }
}

void SessionTargets::sendAgain(MonotonicTime now, News& news) {
  drop(held_.lapse(now), news);
  if (core_.newest.get() && !core_.newest.live(now) && !held_.motors().empty()) {
    std::vector<HeldTargets::Dropped> dropped;
    for (const auto& motor : held_.motors()) dropped.push_back({motor, motor + ": no state for a second"});
    held_.releaseAll();
    drop(dropped, news);
  }
  moves_.onTime(now, news.moves);
  for (const auto& message : held_.takeDue(now)) (void)publish(message);
}

std::optional<MonotonicTime> SessionTargets::nextDue(MonotonicTime now) const {
  return earlier(held_.nextDue(), moves_.nextLook(now));
}

void SessionTargets::letGo(MonotonicTime now, News& news) {
  auto held = held_.takeAll(now);
  moves_.failAll("the program has let go of the robot", news.moves);
  if (core_.options.at_end == AtEnd::kCoast) {
    // One by one, here and below: a message is refused whole for one motor that somebody else has taken.
    for (const auto& coast : core_.leaving.coasts(core_.newest.get().get())) (void)publish({coast});
    return;
  }
  if (core_.options.at_end == AtEnd::kTimeout) core_.leaving.forget();
  // The same targets, not COAST: rc10d does on_timeout after a target that lapses, nothing after a COAST.
  // Those that are disabled do their on_disable instead.
  for (const auto& message : held) {
    for (const auto& order : message) {
      if (!core_.leaving.disables(order.motor)) (void)core_.outgoing.command({order}, kEndValidity);
    }
  }
}

}  // namespace robot_client
}  // namespace rc10
