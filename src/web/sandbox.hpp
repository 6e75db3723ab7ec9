#pragma once

#include <string>
#include <vector>

#include "app/result.hpp"

namespace rc10::web {

/// Gives up, for good, what rc10-web does not need: it reads what any page sends. No real time, bounded
/// memory, no capabilities but root's way into folders of others, not dumpable. Of system calls those of a
/// server that already listens: no programs, no other process, files to read alone, and of new sockets
/// rc10d's. Where the kernel has Landlock, files of these folders and beside them alone. Call it when the
/// server listens and its own files are read.
[[nodiscard]] Result<void> enterSandbox(const std::vector<std::string>& folders);

}  // namespace rc10::web
