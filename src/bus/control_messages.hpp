#pragma once

#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <optional>

#include "app/time.hpp"

namespace rc10 {

/// Ancillary data that the kernel delivers with a frame.
struct ControlMessages {
  std::optional<Duration> realtime_stamp;       ///< SO_TIMESTAMPNS: when it was received, CLOCK_REALTIME.
  std::optional<std::uint32_t> kernel_dropped;  ///< SO_RXQ_OVFL: absent until something was dropped.
};

/// Room for both.
inline constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t));

[[nodiscard]] ControlMessages readControlMessages(const msghdr& message) noexcept;

}  // namespace rc10
