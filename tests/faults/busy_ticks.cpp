// Loaded before rc10d: each tick computes for RC10_BUSY_US (default 12 ms) a bus while RC10_BUSY_TICKS names
// a file that exists.
#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>

namespace {

// Longer than the 10 ms in which the guest's kernel counts the CPU time of a thread.
constexpr long kBusyUs = 12'000;

long now() noexcept {
  timespec time{};
  (void)clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

/// Last call of each tick, once for each bus.
extern "C" int sendmmsg(int fd, mmsghdr* vmessages, unsigned vlen, int flags) {
  using Send = int (*)(int, mmsghdr*, unsigned, int);
  static const auto kSend = reinterpret_cast<Send>(dlsym(RTLD_NEXT, "sendmmsg"));
  static const char* const kWhen = std::getenv("RC10_BUSY_TICKS");
  static const char* const kHow = std::getenv("RC10_BUSY_US");
  static const long kBusyNs = 1000 * (kHow != nullptr ? std::atol(kHow) : kBusyUs);
  const int sent = kSend(fd, vmessages, vlen, flags);
  if (kWhen == nullptr || access(kWhen, F_OK) != 0) return sent;
  for (const long end = now() + kBusyNs; now() < end;) continue;
  return sent;
}
