#pragma once

#include "app/watched_time.hpp"

namespace rc10 {

/// Interlock of an output: after a start, an e-stop or a loss of its line it keeps its safe value until it is
/// commanded that value once. A program that went on commanding through the stop moves nothing when the
/// e-stop is cleared or the cable is plugged in.
class HeldBack {
 public:
  /// Time without a command after which a program has let go: shorter gaps are those of one that sends
  /// rarely.
  static constexpr double kLetGoSeconds = 1.0;

  struct Command {
    bool given = false;  ///< Somebody commands it,
    bool safe = true;    ///< with its safe value; nobody's is safe.
  };
  struct Line {
    bool usable = false;   ///< The robot runs, and the line is there.
    bool dropped = false;  ///< It was lost, or an e-stop is in force that this output obeys.
  };

  /// One tick. True: the safe value counts, whatever is commanded.
  [[nodiscard]] bool step(const Command& command, const Line& line, const Tick& tick) noexcept {
    unasked_.step(tick);
    if (!command.safe) unasked_.restart();
    if (line.dropped) held_ = true;
    const bool let_go = unasked_.seconds() >= kLetGoSeconds;
    if (line.usable && (let_go || (command.given && command.safe))) held_ = false;
    return held_;
  }

 private:
  bool held_ = true;
  WatchedTime unasked_;  ///< Since it was commanded otherwise than safe, or the start.
};

}  // namespace rc10
