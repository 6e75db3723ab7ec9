#pragma once

#include "app/time_grid.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/exchange/note.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

/// With `phase_clock: realtime`, tells that the wall clock was stepped: the ticks stay where they are, and
/// have lost their place among those of other computers. io thread only.
class PhaseWatch {
 public:
  /// `ahead`: of the wall clock, when the grid was laid.
  PhaseWatch(const TimeGrid& ticks, Duration ahead, LinkExchange& exchange) noexcept;

  /// Tells it once, as soon as the ticks are more than a tenth of a period off. A measurement too uncertain
  /// for that is left out.
  void check(const ClockOffset& realtime, MonotonicTime now);

 private:
  TimeGrid ticks_;
  Duration phase_;
  Notes notes_;
  bool lost_ = false;
};

}  // namespace rc10
