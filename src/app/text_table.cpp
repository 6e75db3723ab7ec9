#include "app/text_table.hpp"

#include <algorithm>

#include "app/style.hpp"

namespace rc10 {
namespace {

// Characters, not bytes, of UTF-8.
std::size_t length(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

void TextTable::add(std::vector<std::string> cells, std::string_view style) {
  cells.resize(columns_.size());
  rows_.push_back(std::move(cells));
  styles_.emplace_back(style);
}

std::size_t TextTable::width(std::size_t column) const {
  std::size_t widest = 0;
  for (const auto& row : rows_) widest = std::max(widest, length(row[column]));
  return widest == 0 ? 0 : std::max(widest, length(columns_[column].title));
}

std::string TextTable::line(std::size_t indent, const std::vector<std::size_t>& widths,
                            const std::vector<std::string>& cells) const {
  std::string text;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (widths[i] == 0) continue;
    const std::string padding(widths[i] - length(cells[i]), ' ');
    if (!text.empty()) text += "  ";
    text += columns_[i].align == Align::kRight ? padding + cells[i] : cells[i] + padding;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return std::string(indent, ' ') + text + '\n';
}

std::string TextTable::text(std::size_t indent) const {
  std::vector<std::size_t> widths;
  std::vector<std::string> titles;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    widths.push_back(width(i));
    titles.push_back(columns_[i].title);
  }
  const bool headed =
      std::any_of(titles.begin(), titles.end(), [](const auto& title) { return !title.empty(); });
  std::string text = headed ? line(indent, widths, titles) : std::string{};
  for (std::size_t i = 0; i < rows_.size(); ++i)
    text += style::styled(line(indent, widths, rows_[i]), styles_[i]);
  return text;
}

}  // namespace rc10
