#pragma once

#include <chrono>
#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// Tells drives that are silent from simulated ones whose thread had no processor: those make up for it.
/// Scheduler thread only.
class SimulationWatch {
 public:
  /// Once a tick. `steps`: taken by the simulation so far; 0 without one.
  void look(std::uint64_t steps, MonotonicTime now) noexcept {
    if (steps != steps_) stepped_at_ = now;
    late_ = steps != 0 && steps == steps_ && now - stepped_at_ < kDead;
    steps_ = steps;
  }
  /// No step since the tick before, and not for as long as a simulation that has ended.
  [[nodiscard]] bool late() const noexcept { return late_; }

 private:
  /// Pause after which a simulation has ended, and its drives are silent.
  static constexpr Duration kDead = std::chrono::seconds{1};

  std::uint64_t steps_ = 0;  ///< In the tick before.
  MonotonicTime stepped_at_{};
  bool late_ = false;
};

}  // namespace rc10
