#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rc10::doctor {

/// The kernel's files: /proc, /sys and the like, below a root. A missing or unreadable file is empty.
class HostFiles {
 public:
  explicit HostFiles(std::string root = {}) : root_(std::move(root)) {}

  /// A whole file without blanks at its end. `path` is absolute: "/proc/version".
  [[nodiscard]] std::optional<std::string> read(const std::string& path) const;
  /// The same as a whole number.
  [[nodiscard]] std::optional<long long> number(const std::string& path) const;
  [[nodiscard]] bool exists(const std::string& path) const;
  /// The names in a folder, sorted.
  [[nodiscard]] std::vector<std::string> list(const std::string& path) const;
  /// The last part of what a link points at; empty: no link.
  [[nodiscard]] std::string linkedName(const std::string& path) const;

 private:
  std::string root_;
};

/// "0-2,5" as {0, 1, 2, 5}: how the kernel writes sets of CPUs. Other text is skipped.
[[nodiscard]] std::vector<int> cpuList(const std::string& text);

}  // namespace rc10::doctor
