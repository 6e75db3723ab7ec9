#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rc10::web {

/// Facts of an HTTP request that decide whether it is served.
struct Caller {
  std::string_view host;                   ///< Its header.
  std::optional<std::string_view> origin;  ///< Its header; programs that are no browser send none.
  bool loopback = false;                   ///< It comes from this computer.
};

/// Right of a page's connection; an e-stop needs none. Right is that of an entry of `clients`.
enum class PageRight : unsigned char {
  kNothing,  ///< Until it shows the token.
  kLook,     ///< Sees everything; moves, clears and changes nothing.
  kCommand,
};

/// Names that a page of this server is opened by, besides addresses and localhost.
using HostNames = std::vector<std::string>;

/// Empty: it is served. Else why not. Names of others are refused, so that no page of theirs reaches this
/// server by a name that they let point here (DNS rebinding); an Origin of another page is refused.
[[nodiscard]] std::string refusal(const Caller& caller, const HostNames& names);

/// From this computer everything is allowed. From others the token allows to look: this is plain HTTP, and
/// whoever listens on the way has the token too.
[[nodiscard]] PageRight rightOf(bool loopback, std::string_view shown_token, std::string_view token) noexcept;

}  // namespace rc10::web
