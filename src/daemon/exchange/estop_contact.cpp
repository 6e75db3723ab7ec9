#include "daemon/exchange/estop_contact.hpp"

#include <utility>

namespace rc10 {

EstopContact::View EstopContact::look(float dt_s) noexcept {
  const auto sightings = sightings_.load(std::memory_order_acquire);
  const auto openings = openings_.load(std::memory_order_relaxed);
  auto state = state_.load(std::memory_order_relaxed);
  if (state == ContactState::kAbsent) return {};

  silence_s_ = sightings == std::exchange(seen_sightings_, sightings) ? silence_s_ + dt_s : 0.0F;
  if (silence_s_ > kMaxSilenceSeconds) state = ContactState::kUnreadable;
  open_ = state != ContactState::kClosed;
  const bool opened = openings != std::exchange(seen_openings_, openings);

  View view;
  view.stop = open_ || opened;
  const auto shown = view.stop && !open_ ? opened_as_.load(std::memory_order_relaxed) : state;
  if (shown != std::exchange(told_, shown)) view.news = shown;
  return view;
}

}  // namespace rc10
