#pragma once

#include <optional>
#include <string>

namespace rc10 {

/// Everything in a file; empty if it cannot be opened or read to its end. Never throws for that: a file of
/// /proc can be opened and not be read any more, when its process has ended, and a folder is such a file too.
[[nodiscard]] std::optional<std::string> readWholeFile(const std::string& path);

}  // namespace rc10
