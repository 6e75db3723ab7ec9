#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/late_tick_causes.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "daemon/exchange/tick_ages.hpp"
#include "daemon/exchange/tick_timing.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Rates over the last second, from counters that only grow.
class RateMeter {
 public:
  /// Returns events per second; refreshed about once a second.
  [[nodiscard]] float update(MonotonicTime now, std::uint64_t count) noexcept;

 private:
  MonotonicTime since_{};
  std::uint64_t count_ = 0;
  float rate_hz_ = 0.0F;
};

/// Turns snapshots and counters into the messages that clients get. Link thread only.
class Publication {
 public:
  /// Measurements and counts beside the snapshot.
  struct Measured {
    const TickTiming& timing;
    const TickAges& ages;
    const DurationHistogram& state_ages;  ///< Ages of feedback in a state, when that is sent.
    const LateTickCauses& late;
    std::span<const BusInbox> inboxes;
    const Admission& admission;
    std::span<const std::string> notices{};  ///< Notices of this moment, the first to be told.
    std::uint64_t page_faults = 0;
  };

  explicit Publication(const RobotDescription& robot) : robot_(robot) {}

  [[nodiscard]] link::Welcome welcome() const;
  [[nodiscard]] link::ModuleInfo moduleInfo(std::size_t module) const;
  void fill(link::State& state, const Snapshot& snapshot, std::int64_t utime);
  void fill(link::ModuleState& state, std::size_t module, const Snapshot& snapshot, std::int64_t utime) const;
  void fill(link::Diagnostics& out, const Snapshot& snapshot, const Measured& measured, std::int64_t utime);
  /// A command message that admission refused.
  [[nodiscard]] static link::Event refusal(CommandRefusal reason, const link::Name& client, MonotonicTime now,
                                           std::int64_t utime, const std::string& why = {});
  [[nodiscard]] link::Event event(const Event& event, std::int64_t utime) const;

 private:
  static void fillCounters(link::Diagnostics& out, const Snapshot& snapshot, const LateTickCauses& late);
  void fillDurations(link::Diagnostics& out, const Measured& measured) const;
  void fill(link::BusStatus& out, std::size_t bus, const Snapshot& snapshot, const BusInbox& inbox);

  const RobotDescription& robot_;
  std::array<RateMeter, kMaxMotors> feedback_rates_{};
  std::array<RateMeter, kMaxBuses> bit_rates_{};
};

}  // namespace rc10
