#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "module/module_base.hpp"

namespace rc10 {

/// Channels of a protocol without a checksum: no single frame is believed. A value goes beyond those of the
/// two frames before it by its channel's tolerance at most, and farther once a second frame agrees.
class SteadyChannels {
 public:
  /// `tolerances`: of each channel, in its own unit. 0, of a switch or a key: two frames must be equal.
  explicit SteadyChannels(std::vector<double> tolerances)
      : tolerances_(std::move(tolerances)),
        before_(tolerances_.size(), kNoSignal),
        last_(tolerances_.size(), kNoSignal),
        values_(tolerances_.size(), kNoSignal) {}

  /// Forgets the frames so far, as after a gap.
  void restart() noexcept { frames_ = 0; }

  void take(std::span<const double> frame) noexcept {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] = steady(i, frame[i]);
      before_[i] = std::exchange(last_[i], frame[i]);
    }
    frames_ = std::min(frames_ + 1, 2);
  }

  /// kNoSignal: no two frames agree on it since the restart.
  [[nodiscard]] double operator[](std::size_t channel) const noexcept { return values_[channel]; }

 private:
  [[nodiscard]] double steady(std::size_t channel, double value) const noexcept {
    const double tolerance = tolerances_[channel];
    if (frames_ == 0) return kNoSignal;
    if (frames_ == 1) return std::fabs(value - last_[channel]) <= tolerance ? value : kNoSignal;
    const auto [least, most] = std::minmax(before_[channel], last_[channel]);
    return std::clamp(value, least - tolerance, most + tolerance);
  }

  std::vector<double> tolerances_;
  std::vector<double> before_;  ///< The frame before the last.
  std::vector<double> last_;
  std::vector<double> values_;
  int frames_ = 0;  ///< Since the restart, up to two.
};

}  // namespace rc10
