#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace rc10 {

/// The median of the last `Size` samples, or of as many as there were: single wrong samples leave no
/// trace. Of an even number of samples, the mean of the two in the middle.
///
/// A sample that is not finite is left out.
template <std::size_t Size>
class MedianFilter {
  static_assert(Size % 2 == 1, "an odd number has a middle");

 public:
  double step(double input) noexcept {
    if (!std::isfinite(input)) return value_;
    auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(count_);
    if (count_ == Size) {
      // The oldest makes room.
      const auto oldest = std::lower_bound(sorted_.begin(), end, samples_[next_]);
      std::move(oldest + 1, end, oldest);
      --end;
    } else {
      ++count_;
    }
    const auto place = std::upper_bound(sorted_.begin(), end, input);
    std::move_backward(place, end, end + 1);
    *place = input;
    samples_[next_] = input;
    next_ = (next_ + 1) % Size;
    value_ = 0.5 * sorted_[(count_ - 1) / 2] + 0.5 * sorted_[count_ / 2];
    return value_;
  }
  void reset() noexcept { *this = {}; }
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  std::array<double, Size> samples_{};
  std::array<double, Size> sorted_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  double value_ = 0.0;
};

}  // namespace rc10
