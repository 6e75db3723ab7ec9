#include "web/access.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "app/printable.hpp"

namespace rc10::web {
namespace {

// "[::1]:8010" and "robot.local:8010" without the port.
std::string_view withoutPort(std::string_view host) {
  if (host.starts_with('[')) {
    const auto end = host.find(']');
    return end == std::string_view::npos ? host : host.substr(0, end + 1);
  }
  return host.substr(0, host.rfind(':'));
}

bool isAddress(std::string_view host) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  if (host.starts_with('[') && host.ends_with(']')) {
    const std::string inner{host.substr(1, host.size() - 2)};
    return inet_pton(AF_INET6, inner.c_str(), address.data()) == 1;
  }
  return inet_pton(AF_INET, std::string{host}.c_str(), address.data()) == 1;
}

bool sameName(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace

std::string refusal(const Caller& caller, const HostNames& names) {
  const auto host = withoutPort(caller.host);
  const bool known =
      isAddress(host) || sameName(host, "localhost") ||
      std::any_of(names.begin(), names.end(), [&](const auto& n) { return sameName(n, host); });
  if (!known) {
    return "this server is not opened as '" + printable(host) +
           "': open it by its address, or start rc10-web with --name " + printable(host);
  }
  if (caller.origin && *caller.origin != "http://" + std::string{caller.host} &&
      *caller.origin != "https://" + std::string{caller.host})
    return "a page of '" + printable(*caller.origin) + "' may not use this server";
  return {};
}

PageRight rightOf(bool loopback, std::string_view shown_token, std::string_view token) noexcept {
  if (loopback) return PageRight::kCommand;
  if (token.empty() || shown_token.size() != token.size()) return PageRight::kNothing;
  // The time does not tell how much of it was right.
  unsigned char different = 0;
  for (std::size_t i = 0; i < token.size(); ++i) {
    different = static_cast<unsigned char>(
        different | static_cast<unsigned char>(static_cast<unsigned char>(shown_token[i]) ^
                                               static_cast<unsigned char>(token[i])));
  }
  return different == 0 ? PageRight::kLook : PageRight::kNothing;
}

}  // namespace rc10::web
