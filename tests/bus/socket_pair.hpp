#pragma once

#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <vector>

#include "app/unique_fd.hpp"
#include "bus/wire_frame.hpp"

namespace rc10::test {

/// A feedback frame that can be told from others.
[[nodiscard]] inline CanFrame numbered(std::uint8_t number) {
  return makeClassicFrame({0x201, false}, std::array<std::uint8_t, 8>{number});
}

/// A bus without CAN: `near` is what a bus adopts, `far` is the wire as the test sees it.
struct SocketPair {
  SocketPair() {
    int fds[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds) != 0) {
      ADD_FAILURE() << "socketpair: " << std::strerror(errno);
    }
    near = UniqueFd{fds[0]};
    far = UniqueFd{fds[1]};
  }

  /// Puts raw bytes on the wire.
  void write(const void* bytes, std::size_t size) const {
    EXPECT_EQ(::send(far.get(), bytes, size, MSG_DONTWAIT), static_cast<ssize_t>(size));
  }

  void write(const CanFrame& frame) const {
    canfd_frame wire;
    const std::size_t size = encodeFrame(frame, wire);
    ASSERT_NE(size, 0U);
    write(&wire, size);
  }

  /// Takes everything off the wire.
  [[nodiscard]] std::vector<CanFrame> read() const {
    std::vector<CanFrame> frames;
    for (;;) {
      canfd_frame wire;
      const ssize_t size = ::recv(far.get(), &wire, sizeof(wire), MSG_DONTWAIT);
      if (size <= 0) return frames;
      EXPECT_TRUE(decodeFrame(wire, static_cast<std::size_t>(size), frames.emplace_back()));
    }
  }

  UniqueFd near;
  UniqueFd far;
};

}  // namespace rc10::test
