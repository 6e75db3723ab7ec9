#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "link/link_protocol.hpp"

/// Begin of a connection to rc10d; failures in words for the user.
namespace rc10::client {

using Deadline = std::chrono::steady_clock::time_point;

/// "hero" for ".../hero.sock".
[[nodiscard]] std::string robotOf(const std::string& socket_path);

/// connect() failed with `error`: why, and what to do.
[[nodiscard]] std::string connectFailure(const std::string& socket_path, int error);

[[nodiscard]] Result<UniqueFd> openSocket(const std::string& socket_path, Deadline deadline);

/// Says Hello on a connected socket and waits for the Welcome.
[[nodiscard]] Result<std::unique_ptr<link::Welcome>> greet(int socket, const std::string& socket_path,
                                                           link::Hello hello, Deadline deadline);

}  // namespace rc10::client
