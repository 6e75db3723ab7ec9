#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// A histogram of durations with 16 bins per octave: a percentile is right to 1/16 of its value.
/// One writer, which never waits; any thread may read while it writes.
class DurationHistogram {
 public:
  void record(Duration duration) noexcept;
  /// All that another has recorded so far.
  void add(const DurationHistogram& other) noexcept;

  /// The upper edge of the bin that holds the given fraction (0 to 1) of all records; zero without any.
  [[nodiscard]] Duration percentile(double fraction) const noexcept;
  [[nodiscard]] Duration max() const noexcept { return Duration{max_ns_.load(std::memory_order_relaxed)}; }
  [[nodiscard]] std::uint64_t count() const noexcept;

 private:
  static constexpr unsigned kBinsPerOctave = 16;
  static constexpr std::size_t kBins = std::size_t{kBinsPerOctave} * 32;  // to 2^35 ns, 34 s

  [[nodiscard]] static std::size_t binOf(std::uint64_t ns) noexcept;
  [[nodiscard]] static std::uint64_t upperEdge(std::size_t bin) noexcept;

  std::array<std::atomic<std::uint64_t>, kBins> bins_{};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace rc10
