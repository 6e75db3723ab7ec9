#include "bus/control_messages.hpp"

#include <chrono>
#include <cstring>

namespace rc10 {
namespace {

template <typename T>
std::optional<T> content(const cmsghdr& control) noexcept {
  if (control.cmsg_len < CMSG_LEN(sizeof(T))) return std::nullopt;
  T value{};
  std::memcpy(&value, CMSG_DATA(&control), sizeof(T));
  return value;
}

}  // namespace

ControlMessages readControlMessages(const msghdr& message) noexcept {
  ControlMessages read;
  // CMSG_NXTHDR wants a msghdr that is not const, and does not change it.
  msghdr walked = message;
  for (cmsghdr* control = CMSG_FIRSTHDR(&walked); control != nullptr;
       control = CMSG_NXTHDR(&walked, control)) {
    if (control->cmsg_level != SOL_SOCKET) continue;
    if (control->cmsg_type == SCM_TIMESTAMPNS) {
      if (const auto stamp = content<timespec>(*control)) {
        read.realtime_stamp = std::chrono::seconds{stamp->tv_sec} + std::chrono::nanoseconds{stamp->tv_nsec};
      }
    } else if (control->cmsg_type == SO_RXQ_OVFL) {
      read.kernel_dropped = content<std::uint32_t>(*control);
    }
  }
  return read;
}

}  // namespace rc10
