#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "app/result.hpp"

namespace rc10 {

/// Where LCM sends: a multicast group, a port, and how many hops the datagrams live.
struct LcmUrl {
  std::array<std::uint8_t, 4> group{};
  std::uint16_t port = 0;
  std::uint8_t ttl = 0;  ///< 0: stays on this computer.
};

/// `udpm://A.B.C.D:PORT?ttl=N`; without ttl it is 0, as in LCM. The error is "reason; fix".
[[nodiscard]] Result<LcmUrl> parseLcmUrl(std::string_view url);

}  // namespace rc10
