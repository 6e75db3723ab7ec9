#pragma once

#include <sys/socket.h>

#include <array>
#include <cstddef>

namespace rc10 {

/// Counts the frames that come back to this computer once they were on the wire, and reads nothing of them.
/// The descriptor belongs to somebody else. One thread; no allocation.
class EchoCounter {
 public:
  /// Echoes of one call; further ones wait in the socket.
  static constexpr std::size_t kBatch = 64;

  explicit EchoCounter(int fd) noexcept : fd_(fd) {}

  struct Count {
    std::size_t messages = 0;   ///< kBatch: there may be more.
    std::size_t confirmed = 0;  ///< Frames of these that were sent on this computer.
  };
  /// One system call. Never blocks.
  [[nodiscard]] Count take() noexcept;

 private:
  int fd_;
  std::array<mmsghdr, kBatch> headers_{};
};

}  // namespace rc10
