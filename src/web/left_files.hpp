#pragma once

#include <sys/stat.h>

#include <string>
#include <string_view>

#include "app/unique_fd.hpp"

namespace rc10::web {

/// A file that rc10d left in its run folder: a regular one and no link, or none.
[[nodiscard]] UniqueFd openLeftFile(const std::string& path, struct stat& status);

/// The newest file of this ending; empty: none.
[[nodiscard]] std::string newestLeftFile(const std::string& run_dir, std::string_view ending);

[[nodiscard]] bool isNewer(const timespec& a, const timespec& b) noexcept;

}  // namespace rc10::web
