#pragma once

#include <optional>

#include "link/link_protocol.hpp"

namespace rc10 {

/// The reading end of link::EstopDatagram. RX thread only; the descriptor belongs to somebody else.
class EstopDatagrams {
 public:
  /// Taken in one look. A sender that floods does not lengthen it; what waits is an e-stop all the same.
  static constexpr int kPerLook = 4;

  /// `fd`: a datagram socket.
  explicit EstopDatagrams(int fd) noexcept : fd_(fd) {}

  /// The client that asked for an e-stop since the last call, if one did; of several the first. Never waits.
  [[nodiscard]] std::optional<link::Name> take() const noexcept;
  [[nodiscard]] int descriptor() const noexcept { return fd_; }

 private:
  int fd_;
};

}  // namespace rc10
