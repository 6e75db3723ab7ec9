#include "client/quantity_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace rc10::client {

std::string number(double value, int decimals) {
  if (std::isnan(value)) return "-";
  // Beyond this a fixed-point number is only long.
  const bool huge = std::abs(value) >= 1e9;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), huge ? "%.*g" : "%.*f", huge ? 3 : decimals, value);
  // "-0.0" is noise on a table.
  if (!huge && std::abs(value) < 0.5 * std::pow(10.0, -decimals) && text[0] == '-') return text.data() + 1;
  return text.data();
}

std::string quantity(double value, int decimals, const char* unit) {
  const std::string text = number(value, decimals);
  return *unit == '\0' || text == "-" ? text : text + ' ' + unit;
}

std::string age(std::int32_t age_us) {
  if (age_us < 0) return "-";
  const double age_ms = static_cast<double>(age_us) / 1000.0;
  if (age_ms < 9.95) return quantity(age_ms, 1, "ms");
  return age_ms < 999.5 ? quantity(age_ms, 0, "ms") : quantity(age_ms / 1000.0, 0, "s");
}

std::string percent(double ratio) { return quantity(ratio * 100.0, 0, "%"); }

}  // namespace rc10::client
