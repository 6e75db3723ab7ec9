#pragma once

#include <optional>

#include "link/link_protocol.hpp"

namespace rc10 {

/// The reading end of link::EstopDatagram. Scheduler thread only; the descriptor belongs to somebody else.
class EstopDatagrams {
 public:
  /// Taken in one tick. A sender that floods does not lengthen it; what waits is an e-stop all the same.
  static constexpr int kPerTick = 4;

  /// `fd`: a datagram socket; -1: there is none.
  explicit EstopDatagrams(int fd) noexcept : fd_(fd) {}

  /// The client that asked for an e-stop since the last call, if one did. Never waits; one system call when
  /// none did.
  [[nodiscard]] std::optional<link::Name> take() const noexcept;

 private:
  int fd_;
};

}  // namespace rc10
