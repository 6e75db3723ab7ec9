#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/list_words.hpp"
#include "config/robot_config.hpp"

namespace rc10 {

/// One thing that is wrong with a configuration, or worth knowing about it.
struct ConfigProblem {
  std::string file;
  SourcePlace place;  ///< Line 0: the file as a whole.
  std::string path;   ///< "buses[0].motors[2].id"; empty: the document as a whole.
  std::string text;   ///< "reason; fix"
};

/// `file:line:column: key.path: reason; fix`
/// `kind` stands after the place: "warning: ".
[[nodiscard]] std::string toString(const ConfigProblem& problem, std::string_view kind = {});

/// Collects problems. The same reason at the same place (a profile that ten motors use, an anchor with
/// ten aliases) is one mistake to mend and is kept once, under its first path.
class Problems {
 public:
  static constexpr std::size_t kMost = 500;  ///< Problems kept; a text with more is no config.

  explicit Problems(std::string file) : file_(std::move(file)) {}

  void error(SourcePlace place, std::string path, std::string text);
  void warning(SourcePlace place, std::string path, std::string text);

  [[nodiscard]] bool hasErrors() const noexcept { return !errors_.empty(); }
  [[nodiscard]] bool full() const noexcept { return errors_.size() >= kMost; }

  /// Whether one lies at this path or below it. "": of the document as a whole.
  [[nodiscard]] bool hasErrorsIn(std::string_view path) const noexcept;

  /// In the order of the file.
  [[nodiscard]] std::vector<ConfigProblem> errors() const;
  [[nodiscard]] std::vector<ConfigProblem> warnings() const;

 private:
  std::string file_;
  std::vector<ConfigProblem> errors_;
  std::vector<ConfigProblem> warnings_;
};

/// "motors" + "id" -> "motors.id"
[[nodiscard]] std::string joinPath(std::string_view path, std::string_view key);
/// "motors" + 2 -> "motors[2]"
[[nodiscard]] std::string joinPath(std::string_view path, std::size_t index);

/// Text from the file, printable and short enough for a message.
[[nodiscard]] std::string excerpt(std::string_view text);
/// The same in quotes.
[[nodiscard]] std::string inQuotes(std::string_view text);

}  // namespace rc10
