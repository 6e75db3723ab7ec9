#include "bus/wire_frame.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace rc10 {

std::size_t encodeFrame(const CanFrame& frame, canfd_frame& out) noexcept {
  const bool error = frame.type == FrameType::kError;
  const bool remote = frame.type == FrameType::kRemote;
  const std::uint32_t valid = error ? CAN_ERR_MASK : idMask(frame.id.extended);
  if ((frame.id.value & ~valid) != 0 || !isValidLength(frame.fd, frame.length)) return 0;
  if (frame.fd && frame.type != FrameType::kData) return 0;

  out = {};
  out.can_id = frame.id.value;
  if (error) {
    out.can_id |= CAN_ERR_FLAG;
  } else {
    out.can_id |= (frame.id.extended ? CAN_EFF_FLAG : 0U) | (remote ? CAN_RTR_FLAG : 0U);
  }
  out.len = frame.length;
  if (frame.fd && frame.bit_rate_switch) out.flags = CANFD_BRS;
  if (!remote) std::copy_n(frame.data.begin(), frame.length, std::begin(out.data));
  return frame.fd ? CANFD_MTU : CAN_MTU;
}

bool decodeFrame(const canfd_frame& wire, std::size_t size, CanFrame& out) noexcept {
  const bool fd = size == CANFD_MTU;
  if ((!fd && size != CAN_MTU) || !isValidLength(fd, wire.len)) return false;
  const bool error = (wire.can_id & CAN_ERR_FLAG) != 0;
  const bool remote = !error && (wire.can_id & CAN_RTR_FLAG) != 0;
  if (fd && (error || remote)) return false;

  out = CanFrame{};
  out.fd = fd;
  out.length = wire.len;
  if (error) {
    out.type = FrameType::kError;
    out.id = {wire.can_id & CAN_ERR_MASK, false};
  } else {
    const bool extended = (wire.can_id & CAN_EFF_FLAG) != 0;
    out.type = remote ? FrameType::kRemote : FrameType::kData;
    out.id = {wire.can_id & idMask(extended), extended};
    out.bit_rate_switch = fd && (wire.flags & CANFD_BRS) != 0;
  }
  if (!remote) std::copy_n(std::begin(wire.data), wire.len, out.data.begin());
  return true;
}

std::size_t encodeFrame(const CanFrame& frame, StampedFrame& out) noexcept {
  const std::size_t bytes = encodeFrame(frame, out.frame);
  if (bytes == 0) return 0;
  const std::int64_t stamp_ns = frame.received.time_since_epoch().count();
  std::memcpy(reinterpret_cast<std::byte*>(&out) + bytes, &stamp_ns, sizeof(stamp_ns));
  return bytes + sizeof(stamp_ns);
}

bool decodeFrame(const StampedFrame& wire, std::size_t size, CanFrame& out) noexcept {
  std::int64_t stamp_ns = 0;
  const bool stamped = size == CAN_MTU + sizeof(stamp_ns) || size == CANFD_MTU + sizeof(stamp_ns);
  const std::size_t bytes = stamped ? size - sizeof(stamp_ns) : size;
  if (!decodeFrame(wire.frame, bytes, out)) return false;
  if (stamped) {
    std::memcpy(&stamp_ns, reinterpret_cast<const std::byte*>(&wire) + bytes, sizeof(stamp_ns));
    out.received = MonotonicTime{Duration{stamp_ns}};
  }
  return true;
}

}  // namespace rc10
