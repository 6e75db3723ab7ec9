#pragma once

#include <linux/can.h>

#include <cstddef>
#include <cstdint>

#include "bus/can_frame.hpp"

namespace rc10 {

/// Form of a frame in SocketCAN: a struct can_frame (16 bytes) or a struct canfd_frame (72 bytes). The
/// first is a prefix of the second, so one buffer serves for both and the size tells them apart.
static_assert(offsetof(can_frame, data) == offsetof(canfd_frame, data));
static_assert(offsetof(can_frame, len) == offsetof(canfd_frame, len));
static_assert(sizeof(can_frame) == CAN_MTU && sizeof(canfd_frame) == CANFD_MTU);

/// Writes `frame` to `out`, every byte of it, and returns how many bytes to send: 16 or 72, or 0 if no
/// such frame exists (id out of range, invalid length, remote FD frame).
[[nodiscard]] std::size_t encodeFrame(const CanFrame& frame, canfd_frame& out) noexcept;

/// Reads a message of `size` bytes. False, with `out` untouched, if it is no frame. Leaves `received` at
/// its default.
[[nodiscard]] bool decodeFrame(const canfd_frame& wire, std::size_t size, CanFrame& out) noexcept;

/// A frame of a simulated bus: behind the 16 or 72 bytes stands when it was on the bus, in ns of
/// CLOCK_MONOTONIC. The kernel's stamp tells when it was written, and a thread that was held up writes late.
struct StampedFrame {
  canfd_frame frame;
  std::int64_t room_for_stamp_ns;
};
static_assert(sizeof(StampedFrame) == CANFD_MTU + sizeof(std::int64_t));

/// Writes `frame` and `frame.received`; returns how many bytes to send, or 0 as encodeFrame() does.
[[nodiscard]] std::size_t encodeFrame(const CanFrame& frame, StampedFrame& out) noexcept;

/// Reads a message with or without a stamp; without one, `received` is left at its default.
[[nodiscard]] bool decodeFrame(const StampedFrame& wire, std::size_t size, CanFrame& out) noexcept;

}  // namespace rc10
