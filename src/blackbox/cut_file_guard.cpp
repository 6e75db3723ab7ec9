#include "blackbox/cut_file_guard.hpp"

#include <signal.h>
#include <sys/mman.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <mutex>

namespace rc10::blackbox {
namespace {

// A daemon has one; tests have some at a time.
constexpr std::size_t kMostWatched = 8;

struct WatchedMapping {
  std::atomic<void*> begin{nullptr};  ///< Null: a free place. Written last.
  std::atomic<std::size_t> bytes{0};
  std::atomic<bool> replaced{false};
};

std::array<WatchedMapping, kMostWatched> watched_mappings;
struct sigaction inherited_action {};
std::mutex watching;  // The handler takes no lock.

// In the thread that touched the page, the scheduler's perhaps: one system call, no lock, no allocation.
[[nodiscard]] bool replaceMapping(const void* address) noexcept {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  for (auto& mapping : watched_mappings) {
    void* const begin = mapping.begin.load(std::memory_order_acquire);
    const auto first = reinterpret_cast<std::uintptr_t>(begin);
    const auto bytes = mapping.bytes.load(std::memory_order_relaxed);
    if (begin == nullptr || at < first || at - first >= bytes) continue;
    mapping.replaced.store(true, std::memory_order_release);
    return ::mmap(begin, bytes, PROT_READ | PROT_WRITE, MAP_FIXED | MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) !=
           MAP_FAILED;
  }
  return false;
}

void onBusError(int number, siginfo_t* info, void* /*context*/) {
  const int error = errno;
  // A bad memory cell (BUS_MCEERR_AR) is the kernel's to punish.
  if (info->si_code == BUS_ADRERR && replaceMapping(info->si_addr)) {
    errno = error;
    return;
  }
  (void)::sigaction(number, &inherited_action, nullptr);
  (void)::raise(number);  // delivered as soon as this returns
}

[[nodiscard]] bool installHandler() noexcept {
  struct sigaction now {};
  if (::sigaction(SIGBUS, nullptr, &now) != 0) return false;
  if ((now.sa_flags & SA_SIGINFO) != 0 && now.sa_sigaction == onBusError) return true;
  inherited_action = now;
  struct sigaction action {};
  action.sa_flags = SA_SIGINFO;
  action.sa_sigaction = onBusError;
  sigemptyset(&action.sa_mask);
  return ::sigaction(SIGBUS, &action, nullptr) == 0;
}

}  // namespace

bool CutFileGuard::watch(void* memory, std::size_t bytes) noexcept {
  const std::scoped_lock lock(watching);
  if (place_ != kNoPlace || !installHandler()) return false;
  for (std::size_t place = 0; place < watched_mappings.size(); ++place) {
    auto& mapping = watched_mappings[place];
    if (mapping.begin.load(std::memory_order_relaxed) != nullptr) continue;
    mapping.replaced.store(false, std::memory_order_relaxed);
    mapping.bytes.store(bytes, std::memory_order_relaxed);
    // Release: the handler sees the size, too.
    mapping.begin.store(memory, std::memory_order_release);
    place_ = place;
    return true;
  }
  return false;
}

bool CutFileGuard::replaced() const noexcept {
  return place_ != kNoPlace && watched_mappings[place_].replaced.load(std::memory_order_acquire);
}

CutFileGuard::~CutFileGuard() {
  if (place_ != kNoPlace) watched_mappings[place_].begin.store(nullptr, std::memory_order_release);
}

}  // namespace rc10::blackbox
