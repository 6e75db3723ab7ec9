#include "robot_client/session/session_estop.hpp"

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
  return fail("the state of robot '" + core_.name + "' does not show ESTOP after " + inMs(timeout) +
              ": use the hardware emergency stop. " + core_.whatToCheck());
}

Result<void> SessionEstop::send(std::int64_t number, MonotonicTime now) {
  repetition_.sent(number, now);
  return core_.outgoing.request(number, toString(Operation::kEstop), "", {});
}

}  // namespace robot_client
}  // namespace rc10
