#include "client/screen_fit.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

namespace rc10::client {
namespace {

using Lines = std::vector<std::string_view>;

Lines linesOf(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const auto end = text.find('\n');
    lines.push_back(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return lines;
}

// One behind the escape sequence (ESC [ ... letter) or the character of UTF-8 that begins at `start`.
std::size_t endOf(std::string_view line, std::size_t start) {
  std::size_t end = start + 1;
  if (line[start] == '\x1b') {
    if (end < line.size() && line[end] == '[') ++end;
    while (end < line.size() && (line[end] < '@' || line[end] > '~')) ++end;
    return std::min(end + 1, line.size());
  }
  while (end < line.size() && (static_cast<unsigned char>(line[end]) & 0xC0U) == 0x80U) ++end;
  return end;
}

// Escape sequences have no width, and go on behind the cut: one of them ends the colour.
std::string clipped(std::string_view line, std::size_t columns) {
  std::string text;
  std::size_t shown = 0;
  for (std::size_t at = 0; at < line.size();) {
    const auto end = endOf(line, at);
    const bool escape = line[at] == '\x1b';
    if (escape || shown < columns) text += line.substr(at, end - at);
    if (!escape) ++shown;
    at = end;
  }
  return text;
}

// As many as there is room for; the last line tells of the others.
void fit(Lines& modules, std::string& notice, std::size_t rows) {
  const std::size_t all = modules.size();
  if (all <= rows) return;
  modules.resize(rows > 0 ? rows - 1 : 0);
  if (rows > 0)
    notice = std::to_string(all - modules.size()) + " of " + std::to_string(all) +
             " modules are not shown: `rc10ctl modules` shows them";
}

// Motors make room first, then what stands between the headline and them.
void makeRoom(Lines& head, Lines& motors, const Lines& below, std::string& notice, std::size_t rows) {
  if (head.size() + motors.size() + below.size() <= rows) return;
  const std::size_t all = motors.size();
  const std::size_t taken = head.size() + below.size() + 1;  // 1: the notice
  motors.resize(std::min(motors.size(), rows > taken ? rows - taken : 0));
  notice = std::to_string(all - motors.size()) + " of " + std::to_string(all) +
           " motors are not shown: the terminal has too few rows";
  while (head.size() > 1 && head.size() + below.size() + 1 > rows) head.erase(head.begin() + 1);
}

}  // namespace

std::string fitted(const Picture& picture, ScreenSize size) {
  auto head = linesOf(picture.text);
  const auto first_motor = head.end() - static_cast<std::ptrdiff_t>(std::min(picture.motors, head.size()));
  Lines motors(first_motor, head.end());
  head.erase(first_motor, head.end());
  const auto below = linesOf(picture.below);
  std::string notice;
  const std::size_t rows = std::max<std::size_t>(size.rows, 2) - 1;
  if (size.rows != 0) makeRoom(head, motors, below, notice, rows);
  auto modules = linesOf(picture.modules);
  std::string modules_notice;
  const std::size_t taken = head.size() + motors.size() + below.size() + (notice.empty() ? 0 : 1);
  if (size.rows != 0) fit(modules, modules_notice, rows > taken ? rows - taken : 0);
  Lines lines = std::move(head);
  lines.insert(lines.end(), motors.begin(), motors.end());
  if (!notice.empty()) lines.emplace_back(notice);
  lines.insert(lines.end(), modules.begin(), modules.end());
  if (!modules_notice.empty()) lines.emplace_back(modules_notice);
  lines.insert(lines.end(), below.begin(), below.end());
  if (size.rows != 0) lines.resize(std::min(lines.size(), rows));
  std::string text;
  for (const auto line : lines) {
    text += size.columns == 0 ? std::string{line} : clipped(line, std::max<std::size_t>(size.columns, 2) - 1);
    text += '\n';
  }
  return text;
}

}  // namespace rc10::client
