#pragma once

namespace rc10::client {

/// Where rc10d has told why, for the end of a message: of a service, whatever the robot's file is called, or
/// of a terminal.
inline constexpr const char* kSeeItsLog = "see its log: `journalctl -eu 'rc10d*'`, or the terminal of rc10d";

}  // namespace rc10::client
