#include "web/trace_store.hpp"

#include <algorithm>

namespace rc10::web {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

}  // namespace

TraceStore::TraceStore(std::size_t rows) : times_us_(rows), slots_(link::kMaxTraceSignals) {}

void TraceStore::clear() {
  first_ = count_ = 0;
  order_.clear();
  for (auto& slot : slots_) slot = {};
}

const TraceStore::Slot* TraceStore::slotOf(const link::TraceSignal& signal) const noexcept {
  const auto found = std::find_if(slots_.begin(), slots_.end(),
                                  [&](const Slot& slot) { return slot.used && slot.signal == signal; });
  return found == slots_.end() ? nullptr : &*found;
}

void TraceStore::choose(std::span<const link::TraceSignal> signals) {
  for (auto& slot : slots_)
    slot.current = slot.used && std::find(signals.begin(), signals.end(), slot.signal) != signals.end();
  order_.clear();
  for (const auto& signal : signals.first(std::min(signals.size(), slots_.size()))) {
    auto found = std::find_if(slots_.begin(), slots_.end(),
                              [&](const Slot& slot) { return slot.current && slot.signal == signal; });
    if (found == slots_.end()) {
      found = std::find_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return !slot.current; });
      *found = Slot{.used = true,
                    .current = true,
                    .signal = signal,
                    .values = std::vector<float>(times_us_.size(), kNoValue)};
    }
    order_.push_back(static_cast<std::size_t>(found - slots_.begin()));
  }
  // A signal that is not watched any more needs no room.
  for (auto& slot : slots_) {
    if (!slot.current) slot = {};
  }
}

void TraceStore::add(const link::TraceRow& row) {
  // Time that runs backwards is another computer's.
  if (count_ > 0 && row.mono_us <= newestUs()) return;
  std::size_t at = 0;
  if (count_ < times_us_.size()) {
    at = place(count_++);
  } else {
    at = first_;
    first_ = (first_ + 1) % times_us_.size();
  }
  times_us_[at] = row.mono_us;
  for (std::size_t i = 0; i < order_.size(); ++i)
    slots_[order_[i]].values[at] = static_cast<float>(row.values[i]);
}

std::int64_t TraceStore::newestUs() const noexcept { return count_ == 0 ? 0 : times_us_[place(count_ - 1)]; }
std::int64_t TraceStore::oldestUs() const noexcept { return count_ == 0 ? 0 : times_us_[first_]; }

// The first row that is not before this time.
std::size_t TraceStore::lowerBound(std::int64_t mono_us) const noexcept {
  std::size_t low = 0;
  std::size_t high = count_;
  while (low < high) {
    const auto middle = (low + high) / 2;
    if (times_us_[place(middle)] < mono_us) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

void TraceStore::columns(const link::TraceSignal& signal, std::int64_t width_us, std::int64_t first,
                         std::span<Column> out) const {
  std::fill(out.begin(), out.end(), Column{});
  const Slot* slot = slotOf(signal);
  if (slot == nullptr || width_us <= 0) return;
  const auto end_us = (first + static_cast<std::int64_t>(out.size())) * width_us;
  for (auto nth = lowerBound(first * width_us); nth < count_; ++nth) {
    const auto at = place(nth);
    if (times_us_[at] >= end_us) break;
    const float value = slot->values[at];
    if (value != value) continue;  // NaN: not reported
    auto& column = out[static_cast<std::size_t>(times_us_[at] / width_us - first)];
    column.min = column.min <= value ? column.min : value;
    column.max = column.max >= value ? column.max : value;
  }
}

}  // namespace rc10::web
