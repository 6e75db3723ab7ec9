#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "app/message_limits.hpp"
#include "app/time.hpp"

namespace rc10 {

/// A stamp from the future is a sender's mistake; it must not prolong the message.
[[nodiscard]] inline MonotonicTime receivedAt(std::int64_t received_ns, MonotonicTime now) noexcept {
  return std::min(MonotonicTime{Duration{received_ns}}, now);
}

/// Time that a request has waited since `received_ns` (CLOCK_MONOTONIC; 0: not known).
[[nodiscard]] inline Duration waitedSince(std::int64_t received_ns, MonotonicTime now) noexcept {
  if (received_ns == 0) return {};
  // No stamp is from before the start of this clock; the difference would not fit.
  return now - std::max(receivedAt(received_ns, now), MonotonicTime{});
}

/// Until when a message acts that was received at `received_ns` (CLOCK_MONOTONIC); nothing if its validity is
/// out of range. 0 ms: the default.
[[nodiscard]] inline std::optional<MonotonicTime> deadlineOf(std::int64_t received_ns,
                                                             std::int32_t validity_ms,
                                                             MonotonicTime now) noexcept {
  const Duration validity = validity_ms == 0 ? kDefaultValidity : std::chrono::milliseconds{validity_ms};
  if (validity <= Duration{0} || validity > kMaxValidity) return std::nullopt;
  return receivedAt(received_ns, now) + validity;
}

}  // namespace rc10
