#include "daemon/clients/late_tick_causes.hpp"

#include <algorithm>

namespace rc10 {
namespace {

// Rivals cost some reads of files in each window: they are watched from the first late tick that had its CPU
// taken until there was none for so long, 10 s.
constexpr int kWatchedWindows = 500;

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

}  // namespace

void LateTickCauses::update(const LateTicks& late, const ThreadFacts& thread) {
  std::array<std::uint64_t, kTickSteps> ticks{};
  std::uint64_t any = 0;
  Duration time{};
  for (std::size_t i = 0; i < kTickSteps; ++i) {
    const auto sum = late.of(static_cast<TickStep>(i));
    ticks[i] = sum.ticks - seen_[i].ticks;
    time += sum.time - seen_[i].time;
    any += ticks[i];
    seen_[i] = sum;
  }
  const auto waited_in_all = thread.waited();
  const Duration waited = waited_in_all && waited_ ? *waited_in_all - *waited_ : Duration{};
  waited_ = waited_in_all;
  const Duration waited_lately = waited + waited_before_;
  waited_before_ = any == 0 ? waited : Duration{};
  const bool taken = any > 0 && 4 * waited_lately >= 3 * time;
  const auto taker = takerOf(taken, waited_lately, thread.rivals);
  // Costlier to ask for; the first time, for those of the start.
  if (any == 0 && page_faults_) return;
  const auto page_faults = thread.page_faults();
  const bool faulted = page_faults_ && page_faults > *page_faults_;
  page_faults_ = page_faults;
  if (taken && !faulted) return countTaken(taker, any);
  for (std::size_t i = 0; i < kTickSteps; ++i) {
    const auto cause = faulted ? LateCause::kPageFault : causeOf(static_cast<TickStep>(i));
    counts_[static_cast<std::size_t>(cause)] += ticks[i];
  }
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
