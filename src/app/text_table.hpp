#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rc10 {

/// Columns of plain text, as wide as their widest cell, two spaces apart. Columns in which every cell is
/// empty are left out; without titles there is no head.
class TextTable {
 public:
  enum class Align : unsigned char { kLeft, kRight };
  struct Column {
    std::string title;
    Align align = Align::kLeft;
  };

  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// `style` goes before the line and a reset behind it, of no width: a terminal's colour.
  void add(std::vector<std::string> cells, std::string_view style = {});
  /// Each line indented by `indent` spaces; none at their ends.
  [[nodiscard]] std::string text(std::size_t indent = 0) const;

 private:
  [[nodiscard]] std::size_t width(std::size_t column) const;
  [[nodiscard]] std::string line(std::size_t indent, const std::vector<std::size_t>& widths,
                                 const std::vector<std::string>& cells) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::string> styles_;  // of each row; mostly empty
};

}  // namespace rc10
