#include "support/frame_calls.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace rc10::test {

FrameCalls& frameCalls() noexcept {
  thread_local FrameCalls calls;
  return calls;
}

void reportDropped(msghdr& message, std::uint32_t count) noexcept {
  message.msg_controllen = CMSG_SPACE(sizeof(count));
  cmsghdr* const control = CMSG_FIRSTHDR(&message);
  control->cmsg_level = SOL_SOCKET;
  control->cmsg_type = SO_RXQ_OVFL;
  control->cmsg_len = CMSG_LEN(sizeof(count));
  std::memcpy(CMSG_DATA(control), &count, sizeof(count));
}

namespace {

// The first use in a thread allocates, to register the destructor: for the main thread, in which tests
// count allocations, that is before any test.
[[maybe_unused]] const FrameCalls& main_threads_calls = frameCalls();

}  // namespace
}  // namespace rc10::test

// The program's own definitions win over the C library's.
extern "C" {

int sendmmsg(int fd, mmsghdr* messages, unsigned count, int flags) {
  auto& calls = rc10::test::frameCalls();
  ++calls.sendmmsg;
  unsigned passed = 0;
  int error = 0;
  while (passed < count) {
    error = calls.refuse ? calls.refuse(messages[passed].msg_hdr) : 0;
    if (error != 0) break;
    ++passed;
  }
  if (passed == 0 && count > 0) {
    errno = error;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_sendmmsg, fd, messages, passed, flags));
}

int recvmmsg(int fd, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  auto& calls = rc10::test::frameCalls();
  ++calls.recvmmsg;
  if (calls.interrupted && calls.interrupted->messages == 0) {
    errno = std::exchange(calls.interrupted, std::nullopt)->error;
    return -1;
  }
  if (calls.interrupted) count = std::min(count, std::exchange(calls.interrupted->messages, 0U));
  const auto received = static_cast<int>(::syscall(SYS_recvmmsg, fd, messages, count, flags, timeout));
  for (int i = 0; i < received && calls.received; ++i) calls.received(messages[i].msg_hdr);
  return received;
}
}
