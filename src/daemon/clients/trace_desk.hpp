#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daemon/exchange/robot_description.hpp"
#include "daemon/exchange/tick_trace.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Signals that clients want of each tick: one choice of all of them, which the scheduler records. Link
/// thread.
class TraceDesk {
 public:
  TraceDesk(const RobotDescription& robot, TickTrace& trace) : robot_(robot), trace_(trace) {}

  /// The newest choice of a connection. A signal that the robot does not have, or that finds no room beside
  /// those of the others, is left out.
  void choose(std::uint64_t connection, const link::TraceChoice& choice);
  /// The connection has ended.
  void forget(std::uint64_t connection);
  [[nodiscard]] bool isWatching(std::uint64_t connection) const noexcept;
  [[nodiscard]] bool idle() const noexcept { return watchers_.empty(); }

  /// The signals that are traced now; no rows.
  void fillChoice(link::Trace& out) const noexcept;
  /// The next rows; false: there are none.
  [[nodiscard]] bool fill(link::Trace& out) noexcept;

 private:
  struct Watcher {
    std::uint64_t connection = 0;
    std::vector<link::TraceSignal> signals;
  };

  [[nodiscard]] bool exists(const link::TraceSignal& signal) const noexcept;
  void publish();

  const RobotDescription& robot_;
  TickTrace& trace_;
  TraceChoice choice_;
  std::vector<Watcher> watchers_;
};

}  // namespace rc10
