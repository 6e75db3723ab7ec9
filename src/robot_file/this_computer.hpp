#pragma once

#include <string>

#include "robot_file/file_desk.hpp"

namespace rc10::robot_file {

/// Action of polkit for a verb: "org.rc10d.config.install".
[[nodiscard]] std::string polkitAction(client::FileVerb verb);

/// polkit, rc10d and systemd of this computer.
[[nodiscard]] Computer thisComputer();

}  // namespace rc10::robot_file
