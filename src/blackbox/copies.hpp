#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "app/result.hpp"

namespace rc10::blackbox {

/// "hero-20261121T160529Z-estop.blackbox". `wall_s`: seconds since 1970, UTC.
[[nodiscard]] std::string copyName(const std::string& robot, std::int64_t wall_s, const std::string& cause);
/// Whether a file of this name is a copy of some robot's black box, not the box itself: both folders may be
/// one.
[[nodiscard]] bool isCopy(std::string_view name) noexcept;

/// Copies the black box `fd`, which may be one that is being written, to `dir`/`copyName`, and onto the disk.
/// It gets its name when it is complete; after an error, as when the disk is full, nothing is left. Takes as
/// long as the disk takes. Returns the path.
[[nodiscard]] Result<std::string> keepCopy(int fd, const std::string& dir, const std::string& robot,
                                           std::int64_t wall_s, const std::string& cause);

/// Removes all but the newest `count` copies of this robot.
void removeOldCopies(const std::string& dir, const std::string& robot, std::size_t count);

}  // namespace rc10::blackbox
