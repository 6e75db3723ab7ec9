#include "bus/can_receiver.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "bus/control_messages.hpp"
#include "bus/wire_frame.hpp"

namespace rc10 {
namespace {

// Set on frames that were sent on this computer and looped back once transmitted: MSG_CONFIRM if by this
// very socket, MSG_DONTROUTE if by any (net/can/raw.c). recvmmsg reports them as received flags. A bus's
// socket does not see its own: another program commands too.
constexpr int kSentHere = MSG_CONFIRM | MSG_DONTROUTE;

// SO_RXQ_OVFL counts in 32 bits and goes on after 2^32. A count that is far behind the last one is that of a
// socket that was opened anew; 0, which the kernel does not tell, may be.
std::uint32_t newlyDropped(std::uint32_t count, std::uint32_t& last) noexcept {
  constexpr std::uint32_t kHalf = 1U << 31U;
  const std::uint32_t more = count - std::exchange(last, count);
  return more < kHalf ? more : count;
}

}  // namespace

struct CanReceiver::Buffers {
  struct Slot {
    StampedFrame message{};
    alignas(cmsghdr) std::array<std::byte, kControlBytes> control{};
    iovec content{};
  };

  Buffers() noexcept {
    for (std::size_t i = 0; i < kBatch; ++i) {
      slots[i].content = {&slots[i].message, sizeof(slots[i].message)};
      msghdr& header = headers[i].msg_hdr;
      header.msg_iov = &slots[i].content;
      header.msg_iovlen = 1;
      header.msg_control = slots[i].control.data();
      header.msg_controllen = kControlBytes;
    }
  }

  std::array<Slot, kBatch> slots{};
  std::array<mmsghdr, kBatch> headers{};
  std::size_t filled = 0;            ///< Headers that the last call has filled.
  std::uint32_t kernel_dropped = 0;  ///< SO_RXQ_OVFL of the last frame.
};

CanReceiver::CanReceiver(int fd) : fd_(fd), buffers_(std::make_unique<Buffers>()) {}
CanReceiver::CanReceiver(CanReceiver&&) noexcept = default;
CanReceiver& CanReceiver::operator=(CanReceiver&&) noexcept = default;
CanReceiver::~CanReceiver() = default;

Reception CanReceiver::receive(const WakeUp& wake, std::span<CanFrame> out) noexcept {
  Reception reception;
  const std::size_t room = std::min(kBatch, out.size());
  // The kernel shortens this one of each header that it fills; the rest stays as it was set up.
  for (mmsghdr& header : std::span(buffers_->headers).first(buffers_->filled)) {
    header.msg_hdr.msg_controllen = kControlBytes;
  }
  const int count =
      ::recvmmsg(fd_, buffers_->headers.data(), static_cast<unsigned>(room), MSG_DONTWAIT, nullptr);
  buffers_->filled = static_cast<std::size_t>(std::max(count, 0));
  if (count < 0) {
    if (errno == EAGAIN || errno == EWOULDBLOCK) {
      left_behind_.reset();
      before_.reset();
      return reception;
    }
    if (errno != EINTR) reception.error = errno;
    // An error comes before the frames that wait with it, and had ended the batch before.
    if (!left_behind_) left_behind_ = before_.value_or(wake);
    return reception;
  }
  // Frames that a batch left behind may be as old as its first one.
  WakeUp since = wake;
  if (left_behind_) {
    since.previous = left_behind_->previous;
    since.previous_offset = left_behind_->previous_offset;
  }
  before_ = since;
  left_behind_.reset();
  if (count > 0 && buffers_->filled == room) left_behind_ = since;
  for (std::size_t i = 0; i < buffers_->filled; ++i) {
    const auto& [header, size] = buffers_->headers[i];
    if (size == 0) {  // SOCK_SEQPACKET: the other end was closed. CAN_RAW has no empty message.
      reception.error = ENODEV;
      break;
    }
    const ControlMessages control = readControlMessages(header);
    reception.kernel_dropped += newlyDropped(control.kernel_dropped.value_or(0), buffers_->kernel_dropped);
    CanFrame& frame = out[reception.frame_count];
    if ((header.msg_flags & MSG_TRUNC) != 0 || !decodeFrame(buffers_->slots[i].message, size, frame)) {
      ++reception.malformed_count;
      continue;
    }
    if (frame.received != MonotonicTime{}) {
      frame.received = std::min(frame.received, wake.now);
    } else {
      frame.received = control.realtime_stamp ? toMonotonic(*control.realtime_stamp, since) : wake.now;
    }
    frame.sent_here = (header.msg_flags & kSentHere) != 0;
    ++reception.frame_count;
  }
  return reception;
}

}  // namespace rc10
