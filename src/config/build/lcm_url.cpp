#include "config/build/lcm_url.hpp"

#include <optional>
#include <string>

#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

/// Takes the text up to `delimiter`, and the delimiter, off the front; all of it if there is none.
std::string_view takeUntil(std::string_view& rest, char delimiter) {
  const auto end = std::min(rest.find(delimiter), rest.size());
  const auto part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

/// A number without leading zeros: inet_aton takes 010 for eight.
std::optional<int> wholeNumber(std::string_view text, int max) {
  const auto value = parseInteger(text);
  if (!value || *value < 0 || *value > max) return std::nullopt;
  return static_cast<int>(*value);
}

tl::unexpected<Error> wrong(std::string_view what, std::string_view text, std::string_view fix) {
  return fail(std::string{what} + " '" + std::string{text} + "' is not valid; " + std::string{fix});
}

}  // namespace

Result<LcmUrl> parseLcmUrl(std::string_view url) {
  constexpr std::string_view kScheme = "udpm://";
  constexpr std::string_view kTtl = "ttl=";
  if (url.substr(0, kScheme.size()) != kScheme)
    return wrong("the scheme of", url, "use udpm://A.B.C.D:PORT?ttl=N");
  url.remove_prefix(kScheme.size());
  std::string_view options = url;
  std::string_view port = takeUntil(options, '?');
  std::string_view address = takeUntil(port, ':');

  LcmUrl parsed;
  std::string_view octets = address;
  for (auto& octet : parsed.group) {
    const auto value = wholeNumber(takeUntil(octets, '.'), 255);
    if (!value) return wrong("the address", address, "use four numbers of 0 to 255 without leading zeros");
    octet = static_cast<std::uint8_t>(*value);
  }
  if (!octets.empty())
    return wrong("the address", address, "use four numbers of 0 to 255 without leading zeros");
  if ((parsed.group[0] & 0xF0U) != 0xE0U) {
    return wrong("the address", address, "use a multicast group, 224.0.0.0 to 239.255.255.255");
  }
  const auto port_number = wholeNumber(port, 65'535);
  if (!port_number || *port_number == 0) return wrong("the port", port, "use 1 to 65535");
  parsed.port = static_cast<std::uint16_t>(*port_number);
  if (options.empty()) return parsed;
  const bool has_ttl = options.substr(0, kTtl.size()) == kTtl;
  const auto ttl = has_ttl ? wholeNumber(options.substr(kTtl.size()), 255) : std::nullopt;
  if (!ttl) return wrong("the option", options, "use ttl=0 to ttl=255, without leading zeros");
  parsed.ttl = static_cast<std::uint8_t>(*ttl);
  return parsed;
}

}  // namespace rc10
