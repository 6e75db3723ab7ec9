#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "module/module_base.hpp"

namespace rc10 {

/// Channels of a protocol without a checksum: no single frame is believed. A switch or a key changes once two
/// frames in a row agree. Any other channel goes beyond the two frames before by its tolerance at most.
class SteadyChannels {
 public:
  /// `tolerances`: of each channel, in its own unit; 0: of a switch or a key.
  explicit SteadyChannels(std::vector<double> tolerances)
      : tolerances_(std::move(tolerances)),
        before_(tolerances_.size(), kNoSignal),
        last_(tolerances_.size(), kNoSignal),
        values_(tolerances_.size(), kNoSignal) {}

  /// Forgets the frames so far, as after a gap.
  void restart() noexcept { frames_ = 0; }

  void take(std::span<const double> frame) noexcept {
    settled_ = true;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] = steady(i, frame[i]);
      before_[i] = std::exchange(last_[i], frame[i]);
      settled_ = settled_ && std::isfinite(values_[i]);
    }
    frames_ = std::min(frames_ + 1, 2);
  }

  /// Two frames have come since the restart: it was no noise that looked like one.
  [[nodiscard]] bool heard() const noexcept { return frames_ == 2; }
  /// Every channel has a value.
  [[nodiscard]] bool settled() const noexcept { return settled_; }
  /// kNoSignal: no two frames agree on it since the restart.
  [[nodiscard]] double operator[](std::size_t channel) const noexcept { return values_[channel]; }

 private:
  [[nodiscard]] double steady(std::size_t channel, double value) const noexcept {
    if (frames_ == 0) return kNoSignal;
    const double tolerance = tolerances_[channel];
    const bool agrees = std::fabs(value - last_[channel]) <= tolerance;
    if (frames_ == 1) return agrees ? value : kNoSignal;
    if (tolerance == 0.0) return agrees ? value : values_[channel];
    const auto [least, most] = std::minmax(before_[channel], last_[channel]);
    return std::clamp(value, least - tolerance, most + tolerance);
  }

  std::vector<double> tolerances_;
  std::vector<double> before_;  ///< The frame before the last.
  std::vector<double> last_;
  std::vector<double> values_;
  int frames_ = 0;  ///< Since the restart, up to two.
  bool settled_ = false;
};

}  // namespace rc10
