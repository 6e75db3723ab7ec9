#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/unique_fd.hpp"

namespace rc10::link {

/// A datagram that carries open descriptors to another process: unix(7), SCM_RIGHTS.
struct DescriptorMessage {
  static constexpr std::size_t kMaxBytes = std::size_t{64} * 1024;
  static constexpr std::size_t kMaxDescriptors = 4;

  std::string text;
  std::vector<UniqueFd> descriptors;
};

/// False: errno says why. Never waits.
[[nodiscard]] bool sendWithDescriptors(int socket, std::string_view text, std::span<const int> descriptors);

/// False: nothing is there (EAGAIN), the peer is gone (errno 0), or it was longer than a message may be
/// (EMSGSIZE).
/// Never waits.
[[nodiscard]] bool receiveWithDescriptors(int socket, DescriptorMessage& message);

}  // namespace rc10::link
