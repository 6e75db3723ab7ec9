#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "link/trace_signal.hpp"

namespace rc10::web {

/// The chosen signals of the last minute, each tick, and their least and greatest values in columns of any
/// width. Rows are kept for a page that looks back at what it has seen.
class TraceStore {
 public:
  /// Room, in rows; the oldest make way.
  explicit TraceStore(std::size_t rows);

  /// The signals of the rows that follow. Earlier rows of a signal stay.
  void choose(std::span<const link::TraceSignal> signals);
  void add(const link::TraceRow& row);
  /// rc10d has been started anew: its ticks and its signals are others.
  void clear();

  /// CLOCK_MONOTONIC of the newest row; 0: there is none.
  [[nodiscard]] std::int64_t newestUs() const noexcept;
  [[nodiscard]] std::int64_t oldestUs() const noexcept;

  struct Column {
    float min = std::numeric_limits<float>::quiet_NaN();
    float max = std::numeric_limits<float>::quiet_NaN();
  };
  /// Columns [first, first + out.size()) of this width, counted from time 0: a column is the same for
  /// every page. One without a value is NaN.
  void columns(const link::TraceSignal& signal, std::int64_t width_us, std::int64_t first,
               std::span<Column> out) const;

 private:
  struct Slot {
    bool used = false;
    bool current = false;
    link::TraceSignal signal;
    std::vector<float> values;
  };

  [[nodiscard]] const Slot* slotOf(const link::TraceSignal& signal) const noexcept;
  [[nodiscard]] std::size_t lowerBound(std::int64_t mono_us) const noexcept;
  [[nodiscard]] std::size_t place(std::size_t nth) const noexcept {
    return (first_ + nth) % times_us_.size();
  }

  std::vector<std::int64_t> times_us_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> order_;  ///< Slots of the values of a row, in their order.
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace rc10::web
