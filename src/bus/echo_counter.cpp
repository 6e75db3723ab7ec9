#include "bus/echo_counter.hpp"

#include <algorithm>
#include <span>

namespace rc10 {

EchoCounter::Count EchoCounter::take() noexcept {
  // Headers without a buffer: the kernel copies no byte, and sets the flags all the same.
  const int count = ::recvmmsg(fd_, headers_.data(), kBatch, MSG_DONTWAIT, nullptr);
  if (count <= 0) return {};
  const auto messages = std::span(headers_).first(static_cast<std::size_t>(count));
  // MSG_DONTROUTE: sent by any socket of this computer and looped back once transmitted (net/can/raw.c).
  const auto confirmed = std::count_if(messages.begin(), messages.end(), [](const mmsghdr& message) {
    return (message.msg_hdr.msg_flags & MSG_DONTROUTE) != 0;
  });
  return {messages.size(), static_cast<std::size_t>(confirmed)};
}

}  // namespace rc10
