#include "daemon/clients/late_tick_causes.hpp"

namespace rc10 {
namespace {

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
  // Costlier to ask for; the first time, for those of the start.
  if (any == 0 && page_faults_) return;
  const auto page_faults = thread.page_faults();
  const bool faulted = page_faults_ && page_faults > *page_faults_;
  page_faults_ = page_faults;
  const bool taken = 4 * waited_lately >= 3 * time;
  for (std::size_t i = 0; i < kTickSteps; ++i) {
    const auto cause = faulted ? LateCause::kPageFault
                       : taken ? LateCause::kCpuTaken
                               : causeOf(static_cast<TickStep>(i));
    counts_[static_cast<std::size_t>(cause)] += ticks[i];
  }
}

}  // namespace rc10
