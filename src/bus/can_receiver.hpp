#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "app/receive_clock.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

/// Result of one recvmmsg.
struct Reception {
  std::size_t frame_count = 0;       ///< Frames written to the output.
  std::size_t malformed_count = 0;   ///< Messages of a size that is no frame; skipped.
  std::uint32_t kernel_dropped = 0;  ///< Frames that the kernel dropped since the call before.
  /// errno or 0, never EAGAIN. ENETDOWN and ENODEV are link states; ENODEV also stands for the end of a
  /// simulated bus, whose other end was closed.
  int error = 0;
};

/// Receives frames from a descriptor that somebody else owns. One thread. No allocation after
/// construction, one system call per receive().
class CanReceiver {
 public:
  static constexpr std::size_t kBatch = 64;

  explicit CanReceiver(int fd);
  CanReceiver(CanReceiver&&) noexcept;
  CanReceiver& operator=(CanReceiver&&) noexcept;
  ~CanReceiver();

  /// Never blocks. Writes at most min(kBatch, out.size()) frames.
  [[nodiscard]] Reception receive(const WakeUp& wake, std::span<CanFrame> out) noexcept;

 private:
  /// Since when frames may wait: that of the first of several batches, until the socket was empty.
  std::optional<WakeUp> left_behind_;
  std::optional<WakeUp> before_;  ///< The same of the frames of the call before, if it had any.
  struct Buffers;  // mmsghdr, iovec and control buffers: set up once, they point into each other
  int fd_;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace rc10
