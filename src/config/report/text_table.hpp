#pragma once

#include <string>
#include <vector>

namespace rc10 {

/// Rows of cells in aligned columns, two blanks apart. The first row is the head.
class TextTable {
 public:
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  /// One line a row, each indented by `indent` blanks; no blanks at their ends.
  [[nodiscard]] std::string text(std::size_t indent) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace rc10
