#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/result.hpp"

namespace rc10 {

/// The fault confinement state of a controller.
enum class CanState : std::uint8_t { kActive, kWarning, kPassive, kBusOff, kStopped };

/// State of a CAN interface, as the kernel reports it. Empty: not known to its driver (vcan: all of it).
struct CanLink {
  bool up = false;
  bool is_can = false;                        ///< A CAN interface, of whatever kind.
  std::string kind;                           ///< "can": a controller; "vcan", "vxcan": none.
  std::optional<std::uint32_t> bitrate;       ///< bit/s; empty: never set.
  std::optional<double> sample_point;         ///< Share of the bit, 0 to 1.
  std::optional<std::uint32_t> data_bitrate;  ///< Data bitrate of FD's data phase.
  std::optional<double> data_sample_point;
  std::uint32_t restart_ms = 0;  ///< The driver's automatic restart after bus-off; 0: none.
  std::optional<bool> bus_off;
  std::optional<CanState> state;
  bool fd_on = false;
  std::uint32_t modes = 0;  ///< All that are on: CAN_CTRLMODE_… of linux/can/netlink.h.
  std::optional<int> tec;   ///< Error counters of the controller.
  std::optional<int> rec;
  std::uint32_t bus_errors = 0;  ///< These four since the interface exists.
  std::uint32_t times_passive = 0;
  std::uint32_t times_bus_off = 0;
  std::uint64_t rx_lost = 0;       ///< Frames that came and were dropped before any program saw them.
  std::uint32_t queue_length = 0;  ///< txqueuelen
  std::string qdisc;

  [[nodiscard]] bool isController() const noexcept { return kind == "can"; }
};

/// Asks the kernel by rtnetlink; needs no rights. Not for real-time threads: it allocates, and waits for the
/// kernel at most a second. The error names the interface.
[[nodiscard]] Result<CanLink> readCanLink(const std::string& interface);

/// "CAN interface 'can0': cannot WHAT: reason; fix". `error` is errno; `fix` begins with "; ".
[[nodiscard]] tl::unexpected<Error> canLinkFailure(const std::string& interface, const std::string& what,
                                                   int error, const std::string& fix = {});

}  // namespace rc10
