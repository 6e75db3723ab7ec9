#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// Counter of a histogram that one thread alone uses.
class PlainCount {
 public:
  [[nodiscard]] std::uint64_t get() const noexcept { return value_; }
  void set(std::uint64_t value) noexcept { value_ = value; }

 private:
  std::uint64_t value_ = 0;
};

/// A histogram of durations with 16 bins per octave: a percentile is right to 1/16 of its value. All memory
/// is there from the beginning. One writer; `Count` says whether others may read meanwhile.
template <typename Count>
class BasicDurationHistogram {
 public:
  void record(Duration duration) noexcept {
    const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, duration.count()));
    auto& bin = bins_[binOf(ns)];
    bin.set(bin.get() + 1);
    if (ns > max_ns_.get()) max_ns_.set(ns);
  }
  /// All that another has recorded so far.
  void add(const BasicDurationHistogram& other) noexcept {
    for (std::size_t i = 0; i < kBins; ++i) bins_[i].set(bins_[i].get() + other.bins_[i].get());
    max_ns_.set(std::max(max_ns_.get(), other.max_ns_.get()));
  }

  /// The upper edge of the bin that holds the given fraction (0 to 1) of all records; zero without any.
  [[nodiscard]] Duration percentile(double fraction) const noexcept {
    const auto total = count();
    if (total == 0) return Duration{0};
    const auto rank = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(std::ceil(fraction * static_cast<double>(total))));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      seen += bins_[bin].get();
      if (seen >= rank) return std::min(Duration{upperEdge(bin)}, max());
    }
    return max();
  }
  [[nodiscard]] Duration max() const noexcept { return Duration{max_ns_.get()}; }
  [[nodiscard]] std::uint64_t count() const noexcept {
    std::uint64_t total = 0;
    for (const auto& bin : bins_) total += bin.get();
    return total;
  }
  /// Records that are surely not above `limit`: of the bins that end there or below.
  [[nodiscard]] std::uint64_t countUpTo(Duration limit) const noexcept {
    std::uint64_t total = 0;
    // The last bin has no end.
    for (std::size_t bin = 0; bin + 1 < kBins && Duration{upperEdge(bin)} <= limit; ++bin) {
      total += bins_[bin].get();
    }
    return total;
  }

 private:
  static constexpr unsigned kBinsPerOctave = 16;
  static constexpr std::size_t kBins = std::size_t{kBinsPerOctave} * 32;  // to 2^35 ns, 34 s

  // Below 16 ns one bin per nanosecond; above, the leading bit and the four after it choose the bin.
  [[nodiscard]] static std::size_t binOf(std::uint64_t ns) noexcept {
    const auto octave = static_cast<unsigned>(std::bit_width(ns | kBinsPerOctave)) - 5U;  // 0 to 31 ns: 0
    return std::min(std::size_t{kBinsPerOctave} * octave + static_cast<std::size_t>(ns >> octave), kBins - 1);
  }
  [[nodiscard]] static std::uint64_t upperEdge(std::size_t bin) noexcept {
    if (bin < kBinsPerOctave) return bin;
    const auto octave = static_cast<unsigned>(bin / kBinsPerOctave) - 1U;
    const std::uint64_t within = bin % kBinsPerOctave;
    return ((kBinsPerOctave + within + 1U) << octave) - 1U;
  }

  std::array<Count, kBins> bins_{};
  Count max_ns_{};
};

}  // namespace rc10
