#pragma once

#include <string>

namespace rc10::blackbox {

/// The black box of a robot while rc10d runs: <run folder>/<robot>.blackbox.
[[nodiscard]] std::string livePath(const std::string& run_dir, const std::string& robot);

/// Where copies are kept: $RC10_STATE_DIR, else what systemd made ($STATE_DIRECTORY), else /var/lib/rc10d.
[[nodiscard]] std::string stateDir();

}  // namespace rc10::blackbox
