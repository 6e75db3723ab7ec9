#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rc10::ctl {

/// Addresses of this computer at which rc10-web answers, as in a URL.
struct PageAddresses {
  bool here = false;                ///< On loopback.
  std::vector<std::string> others;  ///< For other computers; IPv4 first.
};

/// Asks each address of this computer, a second at most.
[[nodiscard]] PageAddresses findPage(std::uint16_t port);

}  // namespace rc10::ctl
