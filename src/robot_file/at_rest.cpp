#include "robot_file/at_rest.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "app/printable.hpp"
#include "client/link_client.hpp"
#include "link/run_dir.hpp"

namespace rc10::robot_file {
namespace {

// rc10d sends states at 1 Hz at least.
constexpr std::chrono::seconds kPatience{3};

// The process that listens there, as the kernel tells it.
int listenerOf(int socket) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  return ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.pid : 0;
}

}  // namespace

Result<void> atRest(const link::Welcome& robot, const link::State& state) {
  if (state.robot_state != RobotStatus::kRun)
    return fail("the robot is in ESTOP, which a restart would end: `rc10ctl clear` first");
  const auto count =
      std::min({robot.motor_count, state.motor_count, static_cast<std::uint32_t>(link::kMaxMotors)});
  for (std::size_t i = 0; i < count; ++i) {
    const auto status = state.motors[i].status;
    // An on_disable or on_estop that holds a load goes on while the motor is READY.
    const bool acts = state.motors[i].acting != Acting::kNothing;
    if ((status == MotorStatus::kReady && !acts) || status == MotorStatus::kOffline) continue;
    const auto name = printable(robot.motors[i].name.view());
    auto why = "motor '" + name + "' ";
    if (status == MotorStatus::kFault)
      why.append("has a FAULT, which a restart would end: `rc10ctl clear ").append(name).append("` first");
    else if (status == MotorStatus::kReady)
      why.append("is READY, and does what its fallback says (")
          .append(toString(state.motors[i].acting))
          .append("): a restart would let it go; `rc10ctl disable ")
          .append(name)
          .append("` once more does so");
    else
      why.append("is ")
          .append(toString(status))
          .append(": a restart would let it go; `rc10ctl disable` first");
    return fail(why);
  }
  return {};
}

Result<void> robotAtRest(const std::string& robot, int pid) {
  auto rc10d =
      LinkClient::connect(link::socketPath(robot), {.name = "rc10-config", .subscriptions = link::kStates});
  if (!rc10d) return tl::unexpected(rc10d.error());
  if (listenerOf(rc10d->descriptor()) != pid)
    return fail("robot '" + robot + "' is not run by the unit that is to be restarted: restart it by hand");
  std::vector<std::byte> buffer(link::kMaxMessageSize);
  const auto state = std::make_unique<link::State>();
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto received = rc10d->receive(buffer);
    if (received.status == LinkClient::ReceiveStatus::kClosed) break;
    if (received.status == LinkClient::ReceiveStatus::kMessage) {
      if (link::open(received.datagram, *state)) return atRest(rc10d->welcome(), *state);
      continue;
    }
    pollfd entry{.fd = rc10d->descriptor(), .events = POLLIN, .revents = 0};
    (void)::poll(&entry, 1, static_cast<int>(std::chrono::milliseconds{kPatience}.count()));
  }
  return fail("rc10d of robot '" + robot + "' tells no state: `sudo systemctl restart` by hand");
}

}  // namespace rc10::robot_file
