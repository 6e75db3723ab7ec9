#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace rc10 {

/// Operations that `clients` grants. Everybody may observe, and stop the robot.
enum class Right : std::uint8_t {
  kCommand,    ///< Setpoints, inputs of modules, enable, disable, zero.
  kClear,      ///< Faults and e-stops.
  kTune,       ///< Gains.
  kConfigure,  ///< Settings in the memory of a drive, scans of a bus.
};
inline constexpr std::array<std::string_view, 4> kRightWords{"command", "clear", "tune", "configure"};

/// One entry of `clients`: what one of them may do.
struct ClientConfig {
  enum class By : std::uint8_t {
    kLcmName,  ///< Client name of a message on LCM that was sent on this computer.
    kUser,     ///< Name or number of the user at the other end of the link socket.
    kGroup,    ///< The same of one of the user's groups.
    kToken,    ///< SHA-256 of a token that a client of the link socket shows.
  };
  int line = 0;  ///< Line in the file.
  By by = By::kUser;
  std::string who;
  std::array<bool, kRightWords.size()> rights{};
  bool all_motors = false;
  bool all_modules = false;
  std::vector<std::size_t> motors;  ///< Their places among all motors of the robot.
  std::vector<std::size_t> modules;
  std::int32_t max_priority = std::numeric_limits<std::int32_t>::max();

  [[nodiscard]] bool has(Right right) const noexcept { return rights[static_cast<std::size_t>(right)]; }
};

/// `clients`: who else may only observe and stop.
struct ClientsConfig {
  int line = 0;
  std::vector<ClientConfig> entries;
};

/// Line of a key that forbids something; 0: it does not.
using ForbiddenAt = int;

}  // namespace rc10
