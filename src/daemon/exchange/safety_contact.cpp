#include "daemon/exchange/safety_contact.hpp"

#include <utility>

namespace rc10 {

SafetyContact::View SafetyContact::look(float dt_s) noexcept {
  const auto sightings = sightings_.load(std::memory_order_acquire);
  const auto openings = openings_.load(std::memory_order_relaxed);
  auto state = state_.load(std::memory_order_relaxed);
  if (state == ContactState::kAbsent) return {};

  silence_s_ = sightings == std::exchange(seen_sightings_, sightings) ? silence_s_ + dt_s : 0.0F;
  if (silence_s_ > kMaxSilenceSeconds) state = ContactState::kUnreadable;
  open_ = state != ContactState::kClosed;
  const bool opened = openings != std::exchange(seen_openings_, openings);

  View view;
  view.opened = open_ || opened;
  const auto shown = view.opened && !open_ ? opened_as_.load(std::memory_order_relaxed) : state;
  if (shown != std::exchange(told_, shown)) view.news = shown;
  return view;
}

}  // namespace rc10
