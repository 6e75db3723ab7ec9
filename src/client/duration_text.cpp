#include "client/duration_text.hpp"

#include <charconv>
#include <chrono>

namespace rc10::client {

std::optional<Duration> parseDuration(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  auto unit = text.substr(static_cast<std::size_t>(end - text.data()));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  const double scale = unit == "ms" ? 0.001 : unit == "s" || unit.empty() ? 1.0 : unit == "min" ? 60.0 : 0.0;
  const double seconds = value * scale;
  // Written so that NaN fails too.
  if (!(seconds >= 0.001 && seconds <= 86400.0)) return std::nullopt;
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace rc10::client
