#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "gateway/multicast_route.hpp"
#include "gateway/udpm_datagram.hpp"
#include "gateway/udpm_url.hpp"

namespace rc10::gateway {

/// LCM's UDP multicast, without liblcm: docs/decisions/0006. liblcm's receive stamp is the time at which
/// its reader thread got round to a datagram, so that a command that waited looks fresh; here it is the
/// kernel's. Nothing waits and nothing grows.
class UdpmSocket {
 public:
  /// Receives the given channels only, and only what comes in by the route's interface for the group.
  [[nodiscard]] static Result<UdpmSocket> open(const UdpmUrl& url, const MulticastRoute& route,
                                               const std::vector<std::string>& channels);

  struct Incoming {
    UdpmDatagram datagram;
    in_addr sender{};
    std::optional<Duration> stamp;  ///< CLOCK_REALTIME at which the kernel received it.
  };
  /// The next datagram, in `buffer`; empty when there is none. A longer one is cut off.
  [[nodiscard]] std::optional<Incoming> receive(std::span<std::byte> buffer) noexcept;

  /// Never waits. False: dropped.
  [[nodiscard]] bool publish(std::string_view channel, std::span<const std::byte> bytes) noexcept;

  [[nodiscard]] int descriptor() const noexcept { return in_.get(); }

 private:
  UdpmSocket(UniqueFd in, UniqueFd out, const UdpmUrl& url) noexcept
      : in_(std::move(in)), out_(std::move(out)), url_(url) {}

  UniqueFd in_;
  UniqueFd out_;
  UdpmUrl url_;
  std::uint32_t sequence_ = 0;
};

}  // namespace rc10::gateway
