#pragma once

#include <linux/netlink.h>
#include <linux/rtnetlink.h>

#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

/// Reading of rtnetlink messages: what a length promises is not there before it was counted.
namespace rc10::netlink {

using Bytes = std::span<const std::byte>;

/// The first bytes as a T; nothing: there are too few.
template <typename T>
[[nodiscard]] std::optional<T> readAs(Bytes bytes) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  T value{};
  if (bytes.size() < sizeof value) return std::nullopt;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

/// The payload of the attribute of a type, empty if there is none.
[[nodiscard]] inline Bytes attribute(Bytes attributes, unsigned short type) noexcept {
  for (;;) {
    const auto header = readAs<rtattr>(attributes);
    if (!header || header->rta_len < sizeof(rtattr) || header->rta_len > attributes.size()) return {};
    if ((header->rta_type & NLA_TYPE_MASK) == type) {
      return attributes.subspan(sizeof(rtattr), header->rta_len - sizeof(rtattr));
    }
    const std::size_t step = RTA_ALIGN(std::size_t{header->rta_len});
    if (step > attributes.size()) return {};
    attributes = attributes.subspan(step);
  }
}

[[nodiscard]] inline std::string text(Bytes bytes) {
  if (bytes.empty()) return {};  // of a null pointer strnlen() may not ask
  const auto* chars = reinterpret_cast<const char*>(bytes.data());
  return {chars, ::strnlen(chars, bytes.size())};
}

}  // namespace rc10::netlink
