#include "gateway/udpm_url.hpp"

#include <arpa/inet.h>

#include <array>
#include <charconv>
#include <optional>

namespace rc10::gateway {
namespace {

constexpr std::string_view kScheme = "udpm://";
constexpr std::string_view kDefaultGroup = "239.255.76.67";
constexpr int kDefaultPort = 7667;

std::optional<int> integer(std::string_view text, int min, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < min || value > max)
    return std::nullopt;
  return value;
}

tl::unexpected<Error> bad(std::string_view url, std::string_view why) {
  return fail("LCM URL '" + std::string(url) + "': " + std::string(why) +
              "; it looks like udpm://239.255.76.67:7667?ttl=0");
}

// One "name=value" after the question mark. False: not understood.
bool readOption(std::string_view option, UdpmUrl& out) {
  const auto equals = option.find('=');
  if (equals == std::string_view::npos) return false;
  const auto name = option.substr(0, equals);
  const auto value = option.substr(equals + 1);
  if (name == "ttl") {
    const auto ttl = integer(value, 0, 255);
    out.ttl = ttl.value_or(0);
    return ttl.has_value();
  }
  if (name == "recv_buf_size") {
    const auto size = integer(value, 0, 1 << 30);
    out.recv_buf_size = size.value_or(0);
    return size.has_value();
  }
  return false;
}

}  // namespace

std::string UdpmUrl::groupText() const {
  std::array<char, INET_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET, &group, text.data(), text.size());
  return text.data();
}

Result<UdpmUrl> parseUdpmUrl(std::string_view url) {
  if (!url.starts_with(kScheme)) return bad(url, "only udpm:// (UDP multicast) is supported");
  const auto rest = url.substr(kScheme.size());
  const auto question = rest.find('?');
  const auto network = rest.substr(0, question);
  const auto colon = network.find(':');
  auto address = network.substr(0, colon);
  if (address.empty()) address = kDefaultGroup;

  UdpmUrl out;
  if (::inet_pton(AF_INET, std::string(address).c_str(), &out.group) != 1 ||
      !IN_MULTICAST(ntohl(out.group.s_addr))) {
    return bad(url,
               "'" + std::string(address) + "' is not a multicast address (224.0.0.0 to 239.255.255.255)");
  }
  auto port = std::optional{kDefaultPort};
  if (colon != std::string_view::npos && colon + 1 < network.size())
    port = integer(network.substr(colon + 1), 1, 65535);
  if (!port) return bad(url, "the port is not a number from 1 to 65535");
  out.port = static_cast<std::uint16_t>(*port);

  auto options = question == std::string_view::npos ? std::string_view{} : rest.substr(question + 1);
  while (!options.empty()) {
    const auto end = options.find('&');
    const auto option = options.substr(0, end);
    if (!readOption(option, out)) return bad(url, "option '" + std::string(option) + "' is not understood");
    options = end == std::string_view::npos ? std::string_view{} : options.substr(end + 1);
  }
  return out;
}

}  // namespace rc10::gateway
