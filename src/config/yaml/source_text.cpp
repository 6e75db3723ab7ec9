#include "config/yaml/source_text.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace rc10 {
namespace {

void reportSize(Problems& problems) {
  problems.error({}, "",
                 "larger than " + std::to_string(kMaxConfigBytes / 1024) + " KiB; this is no configuration");
}

/// Length of the UTF-8 sequence that begins the text; 0: none does. Overlong forms, surrogates and what
/// lies beyond U+10FFFF are not UTF-8 (RFC 3629).
std::size_t sequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool beyond = (first == 0xED && byte(1) > 0x9F) || (first == 0xF4 && byte(1) > 0x8F);
  return overlong || beyond ? 0 : length;
}

/// Tab, line feed, and a carriage return before a line feed.
bool isAllowedControl(std::string_view text) {
  return text[0] == '\t' || text[0] == '\n' || (text[0] == '\r' && text.size() > 1 && text[1] == '\n');
}

std::string_view whyRefused(std::string_view text, std::size_t length) {
  if (length == 0) return "this byte is not UTF-8; save the file as UTF-8";
  const auto byte = static_cast<std::uint8_t>(text[0]);
  if ((byte < 0x20 && !isAllowedControl(text)) || byte == 0x7F) return "a control character; remove it";
  return "";
}

}  // namespace

std::optional<std::string> readSource(const std::string& path, Problems& problems) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    problems.error({}, "", "is a directory; give a YAML file");
    return std::nullopt;
  }
  errno = 0;
  std::ifstream file{path, std::ios::binary};
  std::string text(kMaxConfigBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) {
    problems.error({}, "", std::string{"cannot be read: "} + std::strerror(errno != 0 ? errno : EIO));
    return std::nullopt;
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

bool checkSource(std::string_view text, Problems& problems) {
  if (text.size() > kMaxConfigBytes) {
    reportSize(problems);
    return false;
  }
  SourcePlace place{1, 1};
  while (!text.empty()) {
    const std::size_t length = sequenceLength(text);
    if (const auto reason = whyRefused(text, length); !reason.empty()) {
      problems.error(place, "", std::string{reason});
      return false;
    }
    place = text[0] == '\n' ? SourcePlace{place.line + 1, 1} : SourcePlace{place.line, place.column + 1};
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace rc10
