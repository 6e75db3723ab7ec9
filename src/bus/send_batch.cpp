#include "bus/send_batch.hpp"

#include <cerrno>

#include "bus/wire_frame.hpp"

namespace rc10 {
namespace {

// More frames than this that no one will ever accept are not worth more system calls in this tick.
constexpr int kMaxSkipped = 4;

// The frame itself is refused (an FD frame on an interface that has become classic), not the moment. Since
// the next tick starts packing at what was refused, it would otherwise block the bus for good.
bool refusesFrame(int error) noexcept { return error == EINVAL || error == EMSGSIZE; }

}  // namespace

SendBatch::SendBatch() noexcept {
  for (std::size_t i = 0; i < kCapacity; ++i) {
    contents_[i].iov_base = &frames_[i];
    headers_[i].msg_hdr.msg_iov = &contents_[i];
    headers_[i].msg_hdr.msg_iovlen = 1;
  }
}

bool SendBatch::add(const CanFrame& frame, std::optional<std::size_t> packer) noexcept {
  if (size_ == kCapacity) return false;
  const std::size_t bytes = encodeFrame(frame, frames_[size_]);
  if (bytes == 0) return false;
  contents_[size_].iov_len = bytes;
  Entry& entry = entries_[size_++];
  entry.frame = frame;
  entry.bits = unstuffedBits(shapeOf(frame));
  entry.packer = packer;
  entry.sent = false;
  return true;
}

std::size_t SendBatch::send(int fd) noexcept {
  std::size_t next = 0;
  error_ = 0;
  for (int skipped = 0; next < size_;) {
    // MSG_NOSIGNAL: the other end of a simulated bus may be gone, and SIGPIPE would end the process.
    const int accepted =
        ::sendmmsg(fd, &headers_[next], static_cast<unsigned>(size_ - next), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (accepted > 0) {
      error_ = 0;
      for (int i = 0; i < accepted; ++i) entries_[next++].sent = true;
      break;  // If not all: by the time of a second try these commands would be late anyway.
    }
    error_ = errno;
    if (!refusesFrame(error_) || skipped == kMaxSkipped) break;
    ++skipped;
    ++next;
  }
  return next;
}

}  // namespace rc10
