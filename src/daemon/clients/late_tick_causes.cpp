#include "daemon/clients/late_tick_causes.hpp"

#include <algorithm>
#include <bitset>
#include <numeric>

namespace rc10 {
namespace {

// Rivals cost some reads of files in each window: they are watched from the first late tick that had its CPU
// taken until there was none for so long, 10 s.
constexpr int kWatchedWindows = 500;
// A page fault is the cause of ticks within half a second.
constexpr int kFaultWindows = 25;
// Time constant, in windows, with which the usual wait follows; of a shorter one it grows by this.
constexpr int kUsualWindows = 8;
constexpr Duration kLeastUsual = std::chrono::microseconds{1};

[[nodiscard]] LateCause causeOf(TickStep step) noexcept {
  switch (step) {
    case TickStep::kWake: return LateCause::kTimer;
    case TickStep::kReceive: return LateCause::kReceive;
    case TickStep::kModules: return LateCause::kModules;
    case TickStep::kControl: return LateCause::kControl;
    case TickStep::kSend: return LateCause::kSend;
    case TickStep::kPublish: break;
  }
  return LateCause::kPublish;
}

using StepSet = std::bitset<kTickSteps>;

// Steps that were late for want of the CPU. `waited`, time in the run queue, is attributed to the longest
// step first, the remainder to the next; three quarters of a step's time explain it.
[[nodiscard]] StepSet explained(const std::array<LateTicks::Sum, kTickSteps>& late,
                                Duration waited) noexcept {
  std::array<std::size_t, kTickSteps> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&late](std::size_t a, std::size_t b) { return late[a].time > late[b].time; });
  StepSet taken;
  for (const auto step : order) {
    if (late[step].ticks == 0 || waited <= Duration{} || 4 * waited < 3 * late[step].time) continue;
    taken.set(step);
    waited -= std::min(waited, late[step].time);
  }
  return taken;
}

}  // namespace

void LateTickCauses::update(const LateTicks& late, std::uint64_t ticks, const ThreadFacts& thread) {
  std::array<LateTicks::Sum, kTickSteps> fresh{};
  std::uint64_t any = 0;
  for (std::size_t i = 0; i < kTickSteps; ++i) {
    const auto sum = late.of(static_cast<TickStep>(i));
    if (sum.ticks == seen_[i].ticks) continue;  // its time may be there before its tick
    fresh[i] = {sum.ticks - seen_[i].ticks, sum.time - seen_[i].time};
    any += fresh[i].ticks;
    seen_[i] = sum;
  }
  const Duration waited = waitedUnusually(thread, ticks, any > 0);
  const StepSet taken = explained(fresh, waited);
  const auto taker = takerOf(taken.any(), waited, thread.rivals);
  // Costlier to ask for: in windows without late ticks only now and then, so that old faults are no cause.
  if (any == 0 && --fault_windows_ > 0) return;
  fault_windows_ = kFaultWindows;
  const auto page_faults = thread.page_faults();
  const bool faulted = page_faults_ && page_faults > *page_faults_;
  page_faults_ = page_faults;
  for (std::size_t i = 0; i < kTickSteps; ++i) {
    if (taken[i] && !faulted) {
      countTaken(taker, fresh[i].ticks);
    } else {
      const auto cause = faulted ? LateCause::kPageFault : causeOf(static_cast<TickStep>(i));
      counts_[static_cast<std::size_t>(cause)] += fresh[i].ticks;
    }
  }
}

// In this window and the one before, beyond what the thread waits before any tick.
Duration LateTickCauses::waitedUnusually(const ThreadFacts& thread, std::uint64_t ticks, bool any) {
  const auto in_window = static_cast<std::int64_t>(std::max<std::uint64_t>(ticks - ticks_, 1));
  ticks_ = ticks;
  const auto in_all = thread.waited();
  const bool known = in_all && waited_;
  const Duration waited = known ? *in_all - *waited_ : Duration{};
  waited_ = in_all;
  const Duration usual = usual_.value_or(Duration{});
  const Duration unusual = std::max(waited - in_window * usual, Duration{});
  const Duration lately = unusual + waited_before_;
  waited_before_ = any ? Duration{} : unusual;
  if (!known || any) return lately;
  // No faster than by a part of itself: one long wait, whose late tick is counted in the next window, is not
  // the usual one.
  const Duration step = waited / in_window - usual;
  usual_ = usual_ ? usual + std::min(step, std::max(usual, kLeastUsual)) / kUsualWindows : waited / in_window;
  return lately;
}

// Empty: not known. A rival that used half of the wait is named.
std::string LateTickCauses::takerOf(bool taken, Duration waited, CpuRivals* rivals) {
  if (rivals == nullptr) return {};
  if (taken) watched_windows_ = kWatchedWindows;
  if (watched_windows_ == 0) return {};
  if (--watched_windows_ == 0) {
    rivals->forget();
    return {};
  }
  const bool known = rivals->look();
  return known && taken ? rivals->busiest(waited / 2) : std::string{};
}

void LateTickCauses::countTaken(const std::string& taker, std::uint64_t ticks) {
  const auto known = std::find_if(takers_.begin(), takers_.end(),
                                  [&taker](const Taker& each) { return each.name == taker; });
  if (known != takers_.end()) {
    known->count += ticks;
  } else if (!taker.empty() && takers_.size() < kMaxTakers) {
    takers_.push_back({taker, ticks});
  } else {
    counts_[static_cast<std::size_t>(LateCause::kCpuTaken)] += ticks;
  }
}

}  // namespace rc10
