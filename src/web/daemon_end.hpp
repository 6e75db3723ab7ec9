#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rc10::web {

/// Words that rc10d left in its run folder, for pages without a robot.
struct DaemonEnd {
  std::string refusal;          ///< Reason why its last start failed; empty: it did not.
  std::int64_t refused_at = 0;  ///< Seconds since 1970.
  std::string log;              ///< The last lines of its last run; empty: there was none.
  std::int64_t logged_at = 0;
};

/// End of the named robot, or of the one that was heard last. A part that cannot be read is empty.
[[nodiscard]] DaemonEnd readDaemonEnd(const std::string& run_dir, const std::optional<std::string>& robot);

}  // namespace rc10::web
