#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "app/target.hpp"
#include "app/time.hpp"

namespace rc10::test {

/// Values from `low` to `high`; none if `low` is above it.
struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  [[nodiscard]] bool empty() const noexcept { return low > high; }
  [[nodiscard]] double middle() const noexcept { return 0.5 * low + 0.5 * high; }
  void take(double value, double slack = 0.0) noexcept {
    if (!std::isfinite(value)) return;
    low = std::min(low, value - slack);
    high = std::max(high, value + slack);
  }
  void take(const Span& other) noexcept {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  void grow(double by) noexcept {
    if (empty()) return;
    low -= by;
    high += by;
  }
  /// Its values within the bounds of a magnitude.
  [[nodiscard]] Span within(double most) const noexcept {
    return {std::clamp(low, -most, most), std::clamp(high, -most, most)};
  }
  [[nodiscard]] bool has(double value, double slack) const noexcept {
    return value >= low - slack && value <= high + slack;
  }
};

/// One field of a motor's targets: where its slew limit and the soft start let it be. The soft start leads
/// from where the target began towards the mean of what was asked for since, weighted by time.
struct SlewedField {
  Span last;            ///< Where it was in the last frame, and the way that it may have made since.
  Span fresh;           ///< The same of a target that may have begun since.
  Span start;           ///< Where the target of a soft start began.
  Span asked;           ///< Asked for since.
  bool unread = false;  ///< Frames that were not read may have moved it.

  /// A tick: `begins`: where a target begins that may begin in it; `most`: the way in the tick.
  void pass(const Span& begins, double most) noexcept {
    if (!begins.empty()) fresh.take(begins);
    last.grow(most);
    fresh.grow(most);
  }
  [[nodiscard]] bool known() const noexcept { return !unread && !(last.empty() && fresh.empty()); }
  /// `towards`: values in whose direction limits may have taken it; `most`: the limit of its magnitude.
  [[nodiscard]] bool slewAllows(double value, const Span& towards, double most, double slack) const noexcept {
    const auto allows = [&](const Span& span) {
      if (span.empty()) return false;
      Span all = span.within(most);
      if (!towards.empty()) all.take(towards);
      return all.has(value, slack);
    };
    return allows(last) || allows(fresh);
  }
  /// After this share of a soft start.
  [[nodiscard]] Span softStart(double share) const noexcept {
    return {start.low + share * std::min(0.0, asked.low - start.low),
            start.high + share * std::max(0.0, asked.high - start.high)};
  }
  [[nodiscard]] bool softStartAllows(double value, double share, const Span& towards, double most,
                                     double slack) const noexcept {
    if (start.empty()) return true;
    Span all = softStart(share).within(most);
    if (!towards.empty()) all.take(towards);
    return all.has(value, slack);
  }
  /// It was told so; `limited`: other limits have perhaps moved it.
  void told(double value, bool limited, double slack) noexcept {
    if (limited) {
      last.take(fresh);
    } else {
      last = {};
    }
    last.take(value, slack);
    fresh = {};
    unread = false;
  }
  void forget() noexcept {
    last = fresh = {};
    unread = true;
  }
};

/// The targets of a motor, as far as its frames tell of them.
struct TargetTrack {
  static constexpr std::size_t kFields = 5;
  enum Field : std::size_t { kEffort, kSpeed, kPlace, kLead, kPush };
  std::array<SlewedField, kFields> fields;
  ControlMode mode = ControlMode::kCoast;
  Duration soft{std::chrono::hours{1}};  ///< Targets have acted for so long since it was enabled.
  std::vector<Target> came;              ///< In this tick.
  bool lapsed = false;                   ///< The deadline of one that came has passed in this tick.
  double effort_before = 0.0;            ///< In its last frame, of a spring its sum,
  double value_before = 0.0;             ///< and as the snapshot told it.
  double speed_before = 0.0;
  Target leads;             ///< Target of the last tick, where it acted by a place.
  bool turn_known = false;  ///< Its angle has a reference.
  double first_deg = 0.0;   ///< Where its angle began, from where it went on.
  double place_deg = std::numeric_limits<double>::quiet_NaN();  ///< Where it was last,
  MonotonicTime place_at{};                                     ///< Time of that.
  Span places;                    ///< Where the shaft has been since its target began.
  std::uint64_t begin_ticks = 0;  ///< Left, in which a target may begin.
  int limited_ticks = 0;          ///< Left, in which a spring may come back from what limits had made of it.
  Span held;                      ///< Places where it has been since it is held; none: it is not.

  /// Another mode acts. Between its turns a motor sees no change: then a target goes on from where it was.
  /// Ticks since that.
  std::uint64_t change(ControlMode to, std::uint64_t tick, std::uint64_t turn_ticks) {
    left_[mode] = {fields, places, tick};
    mode = to;
    fields = {};
    places = {};
    const auto left = left_.find(to);
    const auto ticks = left == left_.end() ? turn_ticks : tick - left->second.tick;
    if (ticks >= turn_ticks) return 1;
    fields = left->second.fields;
    places = left->second.places;
    return ticks + 1;
  }
  void expect(MonotonicTime deadline) noexcept { deadlines_[slotOf(deadline)] = true; }
  /// A tick, from one time to the next.
  void lapse(MonotonicTime before, MonotonicTime now) noexcept {
    lapsed = deadlines_[slotOf(now)];
    for (auto time = before; time < now; time += std::chrono::milliseconds{1}) {
      lapsed = lapsed || deadlines_[slotOf(time)];
      if (slotOf(time) != slotOf(now)) deadlines_[slotOf(time)] = false;
    }
  }

 private:
  struct Left {
    std::array<SlewedField, kFields> fields;
    Span places;
    std::uint64_t tick = 0;
  };
  std::map<ControlMode, Left> left_;
  // By milliseconds: a command is valid for a second at most.
  static constexpr std::size_t kSlots = 2048;
  [[nodiscard]] static std::size_t slotOf(MonotonicTime time) noexcept {
    return static_cast<std::size_t>(time.time_since_epoch() / std::chrono::milliseconds{1}) % kSlots;
  }
  std::vector<bool> deadlines_ = std::vector<bool>(kSlots);
};

}  // namespace rc10::test
