#pragma once

namespace rc10::client {

/// Place of the reason, for the end of a message: the journal of the service, whatever its instance, or the
/// terminal.
inline constexpr const char* kSeeItsLog = "see its log: `journalctl -eu 'rc10d*'`, or the terminal of rc10d";

}  // namespace rc10::client
