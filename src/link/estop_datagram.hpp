#pragma once

#include <string>
#include <string_view>

#include "app/unique_fd.hpp"

namespace rc10::link {

/// The way of an e-stop past connections, seats and rings: a datagram that acts in the next tick of rc10d.
/// Nothing is answered; a request beside it is.
class EstopDatagram {
 public:
  /// `socket_path`: of the link socket. Of an rc10d that has none (older than this, or ended) nothing is
  /// sent.
  [[nodiscard]] static EstopDatagram to(const std::string& socket_path) noexcept;

  /// Never waits; no allocation. `client`: for the log, cut to what a name may have. True: it is there, or
  /// others are that were not taken yet.
  bool send(std::string_view client) const noexcept;

 private:
  explicit EstopDatagram(UniqueFd socket) noexcept : socket_(std::move(socket)) {}

  UniqueFd socket_;
};

}  // namespace rc10::link
