#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "app/result.hpp"

namespace rc10::gateway {

/// "udpm://239.255.76.67:7667?ttl=0", as liblcm reads it.
struct UdpmUrl {
  in_addr group{};
  std::uint16_t port = 0;
  int ttl = 0;            ///< 0: datagrams do not leave this computer.
  int recv_buf_size = 0;  ///< Bytes; 0: the system's default.

  [[nodiscard]] std::string groupText() const;
};

/// The error says what is wrong with the URL.
[[nodiscard]] Result<UdpmUrl> parseUdpmUrl(std::string_view url);

}  // namespace rc10::gateway
