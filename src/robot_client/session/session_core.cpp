#include "robot_client/session/session_core.hpp"

#include "robot_client/session/names_heard.hpp"
#include "robot_client/session/session_options.hpp"

namespace rc10 {
inline namespace robot_client {

std::string inMs(Duration duration) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count()) + " ms";
}

SessionCore::SessionCore(std::string robot, const LcmLink& to, RobotOptions given)
    : name(std::move(robot)),
      link(to),
      status(checkSession(name, given).and_then([&] { return link.status(); })),
      options(withClient(std::move(given))),
      problems(name, options.on_problem),
      outgoing(link, name, options.client, options.priority) {}

Result<void> SessionCore::mayWait(const std::string& call) const {
  if (!status) return status;
  if (link.inHandler()) return fail(call + " in a callback would wait for itself");
  return {};
}

Result<void> SessionCore::waitForState(Duration timeout) {
  if (auto may = mayWait("waitForState()"); !may) return may;
  {
    Lock lock(mutex);
    const auto known = newest.received();
    if (changed.wait_for(lock, timeout, [&] { return newest.received() > known; })) return {};
  }
  return fail("no state of robot '" + name + "' within " + inMs(timeout) + ". " + whatToCheck());
}

std::shared_ptr<const RobotState> SessionCore::state() {
  const Lock lock(mutex);
  return newest.get();
}

void SessionCore::foreign(const std::string& channel) {
  {
    const Lock lock(mutex);
    if (!foreign_channels.insert(channel).second) return;
  }
  problems.tell(channel +
                " carries messages with other definitions than this program's: build it with the rc10 that "
                "belongs to this rc10d");
}

std::string SessionCore::whatToCheck() {
  {
    const Lock lock(mutex);
    if (!foreign_channels.empty()) {
      return "Messages with other definitions arrive on " + *foreign_channels.begin() +
             ": build this program with the rc10 that belongs to this rc10d.";
    }
    if (newest.live(timeNow())) {
      return "Its state arrives, so rc10d runs and is heard: see rc10d's log for the reason.";
    }
  }
  if (const auto names = NamesHeard(link, "", ".v1.state").names(NamesHeard::kListen); !names.empty()) {
    return "Heard here: robot " + listOf(names) + ": is the name right?";
  }
  return "Check: is rc10d running (rc10ctl list)? Is its robot called '" + name +
         "' (robot: in its configuration)? Does multicast stay on this computer: 'ip route get "
         "239.255.76.67' "
         "must say 'dev lo', else run: sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1";
}

}  // namespace robot_client
}  // namespace rc10
