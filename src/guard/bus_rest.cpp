#include "guard/bus_rest.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "bus/can_socket.hpp"
#include "bus/wire_frame.hpp"

namespace rc10::guard {

BusRest::BusRest(std::string interface, std::vector<CanFrame> frames)
    : interface_(std::move(interface)), frames_(std::move(frames)) {}

Result<void> BusRest::open() {
  auto socket =
      openCanSocket(interface_, {.frames_per_tick = static_cast<int>(frames_.size()), .send_only = true});
  if (!socket) return tl::unexpected(socket.error());
  socket_ = std::move(socket->fd);
  return {};
}

void BusRest::begin() {
  next_ = 0;
  echoes_ = 0;
  listen();
}

bool BusRest::leaveTo(const BusRest& other) {
  const auto left = std::erase_if(frames_, [&other](const CanFrame& ours) {
    return std::any_of(other.frames_.begin(), other.frames_.end(),
                       [&ours](const CanFrame& theirs) { return theirs.id == ours.id; });
  });
  if (left > 0) begin();
  return !frames_.empty();
}

void BusRest::listen() {
  std::vector<CanId> ids;
  ids.reserve(frames_.size());
  for (const auto& frame : frames_) ids.push_back(frame.id);
  if (socket_ && !hearOwnFrames(socket_.get(), ids)) socket_.reset();
}

void BusRest::step() {
  hear();
  if (done()) return;
  if (!socket_ && --reopen_in_ <= 0) {
    reopen_in_ = kReopenSteps;
    if (open()) listen();
  }
  if (!socket_) return;
  for (std::size_t sent = 0; sent < frames_.size(); ++sent) {
    canfd_frame wire;
    const auto size = encodeFrame(frames_[next_], wire);
    if (::send(socket_.get(), &wire, size, MSG_DONTWAIT) != static_cast<ssize_t>(size)) {
      // A full queue or an interface that is down takes them later; one that has gone gets another socket.
      if (errno == ENODEV || errno == ENXIO || errno == EBADF) socket_.reset();
      return;
    }
    next_ = (next_ + 1) % frames_.size();
  }
}

void BusRest::hear() {
  while (socket_) {
    canfd_frame wire;
    iovec bytes{.iov_base = &wire, .iov_len = sizeof wire};
    msghdr header{};
    header.msg_iov = &bytes;
    header.msg_iovlen = 1;
    if (::recvmsg(socket_.get(), &header, MSG_DONTWAIT) < 0) {
      if (errno == ENODEV) socket_.reset();
      return;
    }
    if ((header.msg_flags & MSG_CONFIRM) != 0) ++echoes_;
  }
}

}  // namespace rc10::guard
