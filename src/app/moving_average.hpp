#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace rc10 {

/// The mean of the last `Size` samples, or of as many as there were.
///
/// A sample that is not finite is left out. Samples beyond 1e100 count as that.
template <std::size_t Size>
class MovingAverage {
  static_assert(Size > 0);

 public:
  double step(double input) noexcept {
    if (!std::isfinite(input)) return value_;
    input = std::clamp(input, -1e100, 1e100);
    sum_ += input - samples_[next_];
    samples_[next_] = input;
    next_ = (next_ + 1) % Size;
    count_ = std::min(count_ + 1, Size);
    // A fresh sum each round: rounding errors do not accumulate.
    if (next_ == 0) sum_ = std::accumulate(samples_.begin(), samples_.end(), 0.0);
    value_ = sum_ / static_cast<double>(count_);
    return value_;
  }
  void reset() noexcept { *this = {}; }
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  std::array<double, Size> samples_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  double sum_ = 0.0;
  double value_ = 0.0;
};

}  // namespace rc10
