#pragma once

#include <string>
#include <vector>

#include "app/vocabulary.hpp"
#include "session.hpp"

namespace rc10::ctl {

/// Sends one request for the named motors (none: all), waits for its answer and prints it.
[[nodiscard]] ExitCode ask(const Global& global, Operation operation, const std::vector<std::string>& motors,
                           const std::vector<link::NamedValue>& values = {});

/// The same over a connection without subscriptions that the caller keeps.
[[nodiscard]] ExitCode askOver(LinkClient& rc10d, const Global& global, Operation operation,
                               const std::vector<std::string>& motors,
                               const std::vector<link::NamedValue>& values = {});

}  // namespace rc10::ctl
