#pragma once

#include <sys/stat.h>

#include <optional>
#include <string>
#include <string_view>

#include "app/unique_fd.hpp"

namespace rc10::web {

/// A file that rc10d left in its run folder: a regular one and no link, or none.
[[nodiscard]] UniqueFd openLeftFile(const std::string& path, struct stat& status);

/// Bytes of such a file, if it is no larger than a configuration may be, and when it was written.
struct LeftText {
  std::string text;
  timespec written{};
};
[[nodiscard]] std::optional<LeftText> readLeft(const std::string& path);

/// Whether files in the run folder may be called by this robot: it has a name, and that is no path.
[[nodiscard]] bool namesFiles(const std::string& robot) noexcept;

/// The newest file of this ending; empty: none. With a robot, those of a start are passed over whose text of
/// the configuration names another one.
[[nodiscard]] std::string newestLeftFile(const std::string& run_dir, std::string_view ending,
                                         const std::optional<std::string>& robot = std::nullopt);

[[nodiscard]] bool isNewer(const timespec& a, const timespec& b) noexcept;

}  // namespace rc10::web
