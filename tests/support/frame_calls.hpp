#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <functional>
#include <optional>

namespace rc10::test {

/// Stands between the code under test and the kernel for the two calls that move frames: counts them,
/// and injects what a socketpair cannot do. One per thread; a test resets it: `frameCalls() = {}`.
struct FrameCalls {
  std::uint64_t sendmmsg = 0;
  std::uint64_t recvmmsg = 0;
  /// The errno with which this message is refused, 0 to let it pass.
  std::function<int(const msghdr&)> refuse{};
  /// The next call receives at most so many messages, the one after it fails with this errno.
  struct Interruption {
    unsigned messages = 0;
    int error = 0;
  };
  std::optional<Interruption> interrupted{};
  /// May change what was received.
  std::function<void(msghdr&)> received{};
};

[[nodiscard]] FrameCalls& frameCalls() noexcept;

/// Writes the drop counter of CAN_RAW (SO_RXQ_OVFL) into a message; a socket pair has none.
void reportDropped(msghdr& message, std::uint32_t count) noexcept;

}  // namespace rc10::test
