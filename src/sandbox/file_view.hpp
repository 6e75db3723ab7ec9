#pragma once

#include <string>
#include <vector>

#include "app/result.hpp"

namespace rc10::sandbox {

/// By Landlock, where the kernel has it: from here on no file is opened but to read, and only in these
/// folders and in those that they lie in (but not in all of the computer), because a folder may come later
/// than the process. Open descriptors stay.
[[nodiscard]] Result<void> readOnlyBeside(const std::vector<std::string>& folders);

}  // namespace rc10::sandbox
