#pragma once

#include <span>
#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

struct CanSocketOptions {
  /// Frames of one tick; SO_SNDBUF is sized for about this many, so that what is in flight is never
  /// older than one or two ticks.
  int frames_per_tick = 8;
  /// Nothing is received: neither frames nor error messages. See hearOwnFrames().
  bool send_only = false;
};

struct CanSocket {
  UniqueFd fd;
  bool fd_frames = false;     ///< The interface carries CAN FD (MTU 72).
  int send_buffer_bytes = 0;  ///< As read back from the kernel.
};

/// Value for SO_SNDBUF that keeps at least one and at most about two ticks' frames in flight.
[[nodiscard]] int sendBufferRequest(int frames_per_tick) noexcept;

/// Opens and binds a CAN_RAW socket: options first, then bind. Main or io thread only: it allocates.
/// The error names the interface, the cause and what to do (interface missing, kernel without CAN).
/// An interface that is down is no error: the first receive reports ENETDOWN.
[[nodiscard]] Result<CanSocket> openCanSocket(const std::string& interface, const CanSocketOptions& options);

/// The index of the CAN interface of this name; it may be one of several names. The error is that of
/// openCanSocket().
[[nodiscard]] Result<int> findCanInterface(const std::string& interface);

/// The index of the interface that a CAN socket is bound to; 0: none. A name may have moved to another one
/// since it was looked up.
[[nodiscard]] int boundInterface(int fd) noexcept;

/// From now on a socket that was opened to send only receives frames of these ids, its own ones too, when the
/// controller has sent them: the kernel marks those MSG_CONFIRM. False: errno.
[[nodiscard]] bool hearOwnFrames(int fd, std::span<const CanId> ids);

/// Opens a second socket that sees the echoes of some command ids when the controller has sent them: the only
/// proof that a frame reached the wire. The kernel marks it MSG_DONTROUTE (sent on this computer), which
/// EchoCounter counts.
[[nodiscard]] Result<UniqueFd> openEchoSocket(const std::string& interface,
                                              std::span<const CanId> command_ids);

}  // namespace rc10
