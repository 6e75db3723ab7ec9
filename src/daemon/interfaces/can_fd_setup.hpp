#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "bus/can_link_settings.hpp"

namespace rc10 {

/// Room for the message below, with a margin.
constexpr std::size_t kFdSetupRoom = 512;

/// The RTM_NEWLINK message that makes an interface a CAN FD one: both bit timings, FD mode, no automatic
/// restart. `seen`: hinderingModes() of it are taken away. Returns the part of
/// `room` that is to be sent. Pure.
[[nodiscard]] std::span<const std::byte> fdSetupMessage(std::span<std::byte, kFdSetupRoom> room,
                                                        unsigned interface_index, const CanLink& seen,
                                                        const CanLinkSettings& wanted);

/// Refusal of the kernel.
struct KernelRefusal {
  int error = 0;       ///< errno
  std::string reason;  ///< In the kernel's own words; empty: it gave none.
};

/// Sends it and waits for the answer, at most a second. The interface has to be down. Main or io thread.
[[nodiscard]] tl::expected<void, KernelRefusal> setUpFd(const std::string& interface, const CanLink& seen,
                                                        const CanLinkSettings& wanted);

}  // namespace rc10
