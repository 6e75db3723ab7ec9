#pragma once

#include <optional>
#include <string>

#include "app/result.hpp"

namespace rc10::gateway {

/// The command line of rc10-lcm. Everything has a default.
struct Options {
  std::optional<std::string> robot;
  std::optional<std::string> socket;
  std::optional<std::string> url;  ///< Empty: the one that rc10d tells.
  bool help = false;
  bool version = false;
};

[[nodiscard]] Result<Options> parseOptions(int argc, char** argv);
[[nodiscard]] const char* helpText() noexcept;

}  // namespace rc10::gateway
