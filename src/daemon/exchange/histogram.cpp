#include "daemon/exchange/histogram.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {

// Below 16 ns one bin per nanosecond; above, the four bits after the leading one choose the bin.
std::size_t DurationHistogram::binOf(std::uint64_t ns) noexcept {
  if (ns < kBinsPerOctave) return static_cast<std::size_t>(ns);
  const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 5U;  // 0 for 16..31
  const auto within = static_cast<std::size_t>((ns >> octave) & (kBinsPerOctave - 1U));
  return std::min(std::size_t{kBinsPerOctave} * (octave + 1U) + within, kBins - 1);
}

std::uint64_t DurationHistogram::upperEdge(std::size_t bin) noexcept {
  if (bin < kBinsPerOctave) return bin;
  const auto octave = static_cast<unsigned>(bin / kBinsPerOctave) - 1U;
  const std::uint64_t within = bin % kBinsPerOctave;
  return ((kBinsPerOctave + within + 1U) << octave) - 1U;
}

void DurationHistogram::record(Duration duration) noexcept {
  const std::int64_t ns = std::max<std::int64_t>(0, duration.count());
  // One writer: a plain load and store is enough, and cheaper than a locked add.
  auto& bin = bins_[binOf(static_cast<std::uint64_t>(ns))];
  bin.store(bin.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (ns > max_ns_.load(std::memory_order_relaxed)) max_ns_.store(ns, std::memory_order_relaxed);
}

void DurationHistogram::add(const DurationHistogram& other) noexcept {
  for (std::size_t i = 0; i < kBins; ++i) {
    const auto more = other.bins_[i].load(std::memory_order_relaxed);
    bins_[i].store(bins_[i].load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
  }
  const auto most_ns =
      std::max(max_ns_.load(std::memory_order_relaxed), other.max_ns_.load(std::memory_order_relaxed));
  max_ns_.store(most_ns, std::memory_order_relaxed);
}

std::uint64_t DurationHistogram::count() const noexcept {
  std::uint64_t total = 0;
  for (const auto& bin : bins_) total += bin.load(std::memory_order_relaxed);
  return total;
}

Duration DurationHistogram::percentile(double fraction) const noexcept {
  const auto total = count();
  if (total == 0) return Duration{0};
  const auto rank = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(fraction * static_cast<double>(total))));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin].load(std::memory_order_relaxed);
    if (seen >= rank) return std::min(Duration{upperEdge(bin)}, max());
  }
  return max();
}

}  // namespace rc10
