#pragma once

#include "app/result.hpp"

namespace rc10::gateway {

/// Gives up, for good, what the gateway does not need: it reads what anyone on the network sends. No
/// real-time priority, no locked memory, bounded memory, no capabilities; where it is root, another user. Of
/// system calls those that LCM takes and no others: no files, no programs, no other process, and of sockets
/// LCM's and the question for its route.
/// Call it after the connection to rc10d is made and before LCM is touched.
/// `parent`: rc10d's process id; if that is our parent, we end with it.
[[nodiscard]] Result<void> enterSandbox(int parent);

}  // namespace rc10::gateway
