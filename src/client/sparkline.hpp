#pragma once

#include <cstddef>
#include <deque>
#include <string>

namespace rc10::client {

/// The last values of a signal as one line of text, the newest at the right.
class Sparkline {
 public:
  explicit Sparkline(std::size_t width) : width_(width) {}

  /// NaN: not reported, a gap.
  void add(double value);
  /// A mark for each value, between the lowest and the highest that is shown. `blocks`: of Unicode, else of
  /// ASCII.
  [[nodiscard]] std::string text(bool blocks) const;
  /// The lowest, the highest and the newest value that is shown; NaN without any.
  [[nodiscard]] double lowest() const noexcept;
  [[nodiscard]] double highest() const noexcept;
  [[nodiscard]] double newest() const noexcept;

 private:
  std::size_t width_;
  std::deque<double> values_;
};

}  // namespace rc10::client
