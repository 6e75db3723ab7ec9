#include "bus/wire_frame.hpp"

#include <algorithm>
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

}  // namespace rc10
