#include "config/yaml/number_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "config/yaml/problem.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kDigits = "0123456789";

/// Takes the digits at the front off; false: there are none.
bool skipDigits(std::string_view& text) {
  const auto end = std::min(text.find_first_not_of(kDigits), text.size());
  text.remove_prefix(end);
  return end > 0;
}

bool skip(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// Length of the JSON number at the front of the text (RFC 8259, section 6).
std::size_t numberLength(const std::string_view whole) {
  std::string_view rest = whole;
  skip(rest, "-");
  if (!skip(rest, "0") && !skipDigits(rest)) return 0;
  std::size_t length = whole.size() - rest.size();
  if (skip(rest, ".") && skipDigits(rest)) length = whole.size() - rest.size();
  rest = whole.substr(length);
  if (skip(rest, "eE")) {
    skip(rest, "+-");
    if (skipDigits(rest)) length = whole.size() - rest.size();
  }
  return length;
}

bool isNumber(std::string_view text) { return !text.empty() && numberLength(text) == text.size(); }

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

std::string without(std::string_view text, char unwanted) {
  std::string kept;
  for (const char c : text) {
    if (c != unwanted) kept += c;
  }
  return kept;
}

/// "010" -> "10"
std::string withoutLeadingZeros(std::string_view text) {
  while (text.size() > 1 && text[0] == '0' && kDigits.find(text[1]) != std::string_view::npos)
    text.remove_prefix(1);
  return std::string{text};
}

/// "0x10" -> "16"; empty if it is not that.
std::string fromPrefixed(std::string_view text) {
  if (text.size() < 3 || text[0] != '0') return "";
  const int base = text[1] == 'x' || text[1] == 'X' ? 16 : text[1] == 'o' ? 8 : text[1] == 'b' ? 2 : 0;
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  if (base == 0) return "";
  const auto [stop, error] = std::from_chars(text.data() + 2, end, value, base);
  return error == std::errc{} && stop == end ? std::to_string(value) : "";
}

bool isNotFinite(std::string_view text) {
  skip(text, "+-");
  skip(text, ".");
  constexpr std::array<std::string_view, 6> kNames{"nan", "NaN", "NAN", "inf", "Inf", "INF"};
  for (const auto name : kNames) {
    if (text == name) return true;
  }
  return text == "infinity" || text == "Infinity";
}

/// Error for a text that is no number, with the number to write. `text` is without its minus sign.
std::string insteadOfNumber(std::string_view text, const std::string& sign) {
  const auto write = [&](const std::string& better) { return "; write " + sign + better; };
  if (isNotFinite(text)) return " is not finite; write a number";
  if (text[0] == '+' && isNumber(text.substr(1)))
    return " has a plus sign" + write(std::string{text.substr(1)});
  if (const auto value = fromPrefixed(text); !value.empty()) return " is not decimal" + write(value);
  if (text[0] == '.' && isNumber("0" + std::string{text}))
    return " begins with a point" + write("0" + std::string{text});
  if (text.back() == '.' && isNumber(text.substr(0, text.size() - 1))) {
    return " ends with a point" + write(std::string{text.substr(0, text.size() - 1)});
  }
  if (const auto better = withoutLeadingZeros(text); better != text && isNumber(better)) {
    return " has a leading zero, which some read as octal" + write(better);
  }
  if (const auto better = without(text, '_'); better != text && isNumber(better)) {
    return " has an underscore" + write(better);
  }
  if (const std::size_t length = numberLength(text);
      length > 0 && text[length] != '.' && text[length] != ',') {
    return " has something after the number" +
           write(std::string{text.substr(0, length)} + ": the unit is in the key's name");
  }
  return " is not a number; write digits, with a point for fractions";
}

template <typename Number>
std::string shortest(Number value) {
  std::array<char, 400> buffer{};  // The longest double without exponent has 309 digits before the point.
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed);
  return error == std::errc{} ? std::string{buffer.data(), end} : std::string{"?"};
}

}  // namespace

Result<double> parseNumber(std::string_view text) {
  if (!isNumber(text)) {
    const bool negative = text.size() > 1 && startsWith(text, "-");
    if (text.empty()) return fail("is empty; write a number");
    return fail(inQuotes(text) + insteadOfNumber(text.substr(negative ? 1 : 0), negative ? "-" : ""));
  }
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{})
    return fail(inQuotes(text) + " cannot be represented; write a smaller number of digits");
  return value;
}

Result<std::int64_t> parseInteger(std::string_view text) {
  const auto number = parseNumber(text);
  if (!number) return tl::unexpected(number.error());
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc{} && stop == end) return value;
  const bool is_whole = std::floor(*number) == *number && std::abs(*number) < 1e15;
  if (is_whole) return fail(inQuotes(text) + " is to be a whole number; write " + numberText(*number));
  return fail(inQuotes(text) + " is not a whole number; remove the fraction");
}

std::string numberText(double value) { return shortest(value); }

std::string numberText(float value) { return shortest(value); }

}  // namespace rc10
