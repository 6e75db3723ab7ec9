#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "app/time.hpp"

namespace rc10::web {

/// Delay of a page's messages on their way, by the page's own clock: how much later than the quickest one
/// each arrives. A message that was held up (a busy browser, a lost packet, a paused server) renews
/// nothing, and asks for nothing but a stop.
class RenewalAge {
 public:
  /// `sent`: by the page's clock, whose zero is not known here.
  [[nodiscard]] Duration ageOf(Duration sent, MonotonicTime arrived) noexcept {
    const Duration offset = arrived.time_since_epoch() - sent;
    if (!quickest_) {
      quickest_ = offset;
    } else {
      // Two clocks drift apart by some 100 ppm: the quickest message tells less as it grows old.
      const Duration passed = std::max(arrived - last_, Duration::zero());
      quickest_ = std::min(offset, *quickest_ + passed / kDriftDivisor);
    }
    last_ = arrived;
    return offset - *quickest_;
  }

 private:
  static constexpr int kDriftDivisor = 1000;

  std::optional<Duration> quickest_;
  MonotonicTime last_{};
};

}  // namespace rc10::web
