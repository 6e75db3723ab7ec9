#include "robot_client/session/session_estop.hpp"

#include <algorithm>

namespace rc10 {
inline namespace robot_client {

Result<void> SessionEstop::estop(Duration timeout) {
  if (!core_.status) return core_.status;
  SessionCore::Lock lock(core_.mutex);
  targets_.release({});
  const auto under_way = repetition_.number();
  const auto number = under_way ? *under_way : core_.outgoing.nextNumber();
  auto sent = send(number, timeNow());
  core_.wake_sender.notify_all();
  if (!sent) return sent;
  if (core_.link.inHandler()) return {};
  if (core_.changed.wait_until(lock, timeNow() + timeout, [&] { return repetition_.number() != number; }))
    return {};
  lock.unlock();
  return notShown(timeout);
}

Result<void> SessionEstop::finish(Duration most) {
  SessionCore::Lock lock(core_.mutex);
  // In a handler no state comes meanwhile: once more, at least.
  const auto end = core_.link.inHandler() ? timeNow() : timeNow() + most;
  if (const auto number = repetition_.number()) (void)send(*number, timeNow());
  while (repetition_.number() && timeNow() < end) {
    sendAgain(timeNow());
    core_.changed.wait_until(lock, std::min(end, nextDue().value_or(end)));
  }
  if (!repetition_.number()) return {};
  lock.unlock();
  return notShown(most);
}

tl::unexpected<Error> SessionEstop::notShown(Duration after) const {
  return fail("the state of robot '" + core_.name + "' does not show ESTOP after " + inMs(after) +
              ": use the hardware emergency stop. " + core_.whatToCheck());
}

Result<void> SessionEstop::send(std::int64_t number, MonotonicTime now) {
  repetition_.sent(number, now);
  return core_.outgoing.request(number, toString(Operation::kEstop), "", {});
}

}  // namespace robot_client
}  // namespace rc10
