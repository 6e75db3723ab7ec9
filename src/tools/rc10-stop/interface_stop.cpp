#include "interface_stop.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "bus/can_socket.hpp"
#include "bus/wire_frame.hpp"

namespace rc10 {

InterfaceStop::InterfaceStop(std::string interface, std::vector<CanFrame> frames)
    : interface_(std::move(interface)), frames_(std::move(frames)) {
  auto socket =
      openCanSocket(interface_, {.frames_per_tick = static_cast<int>(frames_.size()), .send_only = true});
  if (socket) {
    socket_ = std::move(socket->fd);
  } else {
    failure_ = socket.error().message;
  }
}

void InterfaceStop::step() {
  if (ended() || --wait_steps_ > 0) return;
  for (; next_ < frames_.size(); ++next_) {
    canfd_frame wire;
    const auto size = encodeFrame(frames_[next_], wire);
    if (::send(socket_.get(), &wire, size, MSG_DONTWAIT) == static_cast<ssize_t>(size)) continue;
    if (errno == EAGAIN || errno == ENOBUFS || errno == EINTR) return;  // full: again in the next step
    failure_ = "CAN interface '" + interface_ + "': " + std::generic_category().message(errno);
    return;
  }
  next_ = 0;
  ++rounds_;
  wait_steps_ = kRoundSteps;
}

std::string InterfaceStop::problem() const {
  if (!failure_.empty() || rounds_ == kRounds) return failure_;
  return "CAN interface '" + interface_ + "': its queue is full, " +
         std::to_string(static_cast<std::size_t>(rounds_) * frames_.size() + next_) + " of " +
         std::to_string(kRounds * frames_.size()) +
         " frames were accepted: nobody on the bus acknowledges; check power and wiring";
}

}  // namespace rc10
