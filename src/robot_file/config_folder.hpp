#pragma once

#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10::robot_file {

/// The folder of robots' files, of which nobody else of us changes anything while this is there.
class ConfigFolder {
 public:
  /// Backups of a file that stay: the newest.
  static constexpr std::size_t kBackups = 20;

  [[nodiscard]] static Result<ConfigFolder> open(const std::string& path);

  /// The path of a file in it.
  [[nodiscard]] std::string pathOf(const std::string& name) const { return path_ + "/" + name; }
  /// Its bytes; none: there is no such file. Only a file of its own name, no link to another, is read.
  [[nodiscard]] Result<std::optional<std::string>> read(const std::string& name) const;
  /// Either the whole text or the old file, whenever the computer loses its power. Owner and mode stay. The
  /// name of the backup, which is the old file itself; empty: there was none.
  [[nodiscard]] Result<std::string> replace(const std::string& name, const std::string& text,
                                            std::time_t now) const;

 private:
  ConfigFolder(std::string path, UniqueFd folder) : path_(std::move(path)), folder_(std::move(folder)) {}
  [[nodiscard]] Result<std::string> keep(const std::string& name, std::time_t now) const;
  /// Times of the backups of a file, by their names; in order.
  [[nodiscard]] std::vector<std::time_t> backupTimes(const std::string& name) const;
  void dropOldBackups(const std::string& name) const;
  [[nodiscard]] tl::unexpected<Error> failed(const std::string& what, const std::string& name) const;

  std::string path_;
  UniqueFd folder_;
};

}  // namespace rc10::robot_file
