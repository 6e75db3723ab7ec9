#include "module/text_protocol.hpp"

#include <algorithm>
#include <optional>

namespace rc10 {
namespace {

constexpr std::uint8_t kStart = '$';
constexpr std::uint8_t kChecksumMark = '*';
constexpr std::uint8_t kEnd = '\n';
constexpr std::size_t kMostDigits = 15;  // a double holds these exactly
constexpr std::string_view kHexDigits = "0123456789ABCDEF";

[[nodiscard]] bool isDigit(char c) noexcept { return c >= '0' && c <= '9'; }

[[nodiscard]] bool isNameLetter(char c) noexcept {
  return isDigit(c) || c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// Printable, and none of the characters that hold a line together.
[[nodiscard]] bool mayStandInside(std::uint8_t byte) noexcept {
  return byte >= ' ' && byte <= '~' && byte != kStart && byte != kChecksumMark;
}

[[nodiscard]] std::uint8_t exclusiveOr(std::span<const std::uint8_t> bytes) noexcept {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum = static_cast<std::uint8_t>(sum ^ byte);
  return sum;
}

// A decimal number without exponent. Not std::from_chars: that of GCC 11 may allocate.
[[nodiscard]] std::optional<double> numberIn(std::string_view text) noexcept {
  const bool negative = !text.empty() && text.front() == '-';
  if (negative) text.remove_prefix(1);
  double value = 0.0;
  double scale = 1.0;
  std::size_t digits = 0;
  bool fraction = false;
  for (const char c : text) {
    if (c == '.' && !fraction) {
      fraction = true;
      continue;
    }
    if (!isDigit(c) || ++digits > kMostDigits) return std::nullopt;
    value = value * 10.0 + (c - '0');
    if (fraction) scale *= 10.0;
  }
  if (digits == 0) return std::nullopt;
  return (negative ? -value : value) / scale;
}

// "name,1.5,-2"
[[nodiscard]] std::optional<TextMessage> decodeText(std::string_view content) noexcept {
  TextMessage message;
  const auto name = content.substr(0, content.find(','));
  if (name.empty() || name.size() > TextMessage::kLongestName ||
      !std::all_of(name.begin(), name.end(), isNameLetter)) {
    return std::nullopt;
  }
  message.name_length = name.copy(message.name_letters.data(), TextMessage::kLongestName);
  content.remove_prefix(name.size());
  while (!content.empty()) {
    content.remove_prefix(1);  // the comma
    const auto text = content.substr(0, content.find(','));
    const auto value = numberIn(text);
    if (!value || message.value_count == TextMessage::kMostValues) return std::nullopt;
    message.values[message.value_count++] = *value;
    content.remove_prefix(text.size());
  }
  return message;
}

// Text between `$` and `*`, or the reason why there is none.
struct Line {
  ScanVerdict verdict;
  std::string_view content{};
};

// `shown` ends with the first line feed.
[[nodiscard]] Line take(std::span<const std::uint8_t> shown) noexcept {
  auto line = shown.first(shown.size() - 1);
  if (line.back() == '\r') line = line.first(line.size() - 1);
  constexpr std::size_t kTail = 3;  // mark and two digits
  if (line.size() < 1 + kTail || line[line.size() - kTail] != kChecksumMark) return {ScanVerdict::kNoise};
  const auto content = line.subspan(1, line.size() - 1 - kTail);
  const auto high = kHexDigits.find(static_cast<char>(line[line.size() - 2]));
  const auto low = kHexDigits.find(static_cast<char>(line[line.size() - 1]));
  if (high == std::string_view::npos || low == std::string_view::npos) return {ScanVerdict::kNoise};
  if (high * 16 + low != exclusiveOr(content)) return {ScanVerdict::kBadChecksum};
  return {ScanVerdict::kFrame, {reinterpret_cast<const char*>(content.data()), content.size()}};
}

}  // namespace

void TextProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  scanner_.scan(bytes, counters_, [&](std::span<const std::uint8_t> shown) {
    if (shown[0] != kStart || (shown.size() > 1 && shown.back() == kStart)) return ScanVerdict::kNoise;
    if (shown.back() != kEnd) return ScanVerdict::kMore;
    const auto line = take(shown);
    if (line.verdict != ScanVerdict::kFrame) return line.verdict;
    const auto message = decodeText(line.content);
    if (!message) return ScanVerdict::kSkip;
    message_.set(*message, received);
    if (listener_ != nullptr) listener_->onLine(*message, received);
    return ScanVerdict::kFrame;
  });
}

std::size_t TextProtocol::pack_frame(std::span<const std::uint8_t> payload,
                                     std::span<std::uint8_t> out) const noexcept {
  const std::size_t length = payload.size() + 5;
  if (payload.empty() || length > kLongestLine || length > out.size() ||
      !std::all_of(payload.begin(), payload.end(), mayStandInside)) {
    return 0;
  }
  const auto sum = exclusiveOr(payload);
  out[0] = kStart;
  auto at = std::copy(payload.begin(), payload.end(), out.begin() + 1);
  *at++ = kChecksumMark;
  *at++ = static_cast<std::uint8_t>(kHexDigits[sum >> 4U]);
  *at++ = static_cast<std::uint8_t>(kHexDigits[sum & 0xFU]);
  *at = kEnd;
  return length;
}

}  // namespace rc10
