#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstring>
#include <optional>
#include <string>

namespace rc10::link {

/// Longest path of a socket.
inline constexpr std::size_t kMaxSocketPath = sizeof(sockaddr_un::sun_path) - 1;

/// The address of a socket in the file system; empty: its path is too long.
[[nodiscard]] inline std::optional<sockaddr_un> unixAddress(const std::string& path) noexcept {
  if (path.size() > kMaxSocketPath) return std::nullopt;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

}  // namespace rc10::link
