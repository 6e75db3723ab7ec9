#pragma once

#include <chrono>
#include <optional>

#include "app/time.hpp"

namespace rc10 {

/// Interlock of an output: after a start, an e-stop or a loss of its line it keeps its safe value until it is
/// commanded that value once. A program that went on commanding through the stop moves nothing when the
/// e-stop is cleared or the cable is plugged in.
class HeldBack {
 public:
  /// Time without a command after which a program has let go: shorter gaps are those of one that sends
  /// rarely.
  static constexpr Duration kLetGo = std::chrono::seconds{1};

  struct Command {
    bool given = false;  ///< Somebody commands it,
    bool safe = true;    ///< with its safe value; nobody's is safe.
  };
  struct Line {
    bool usable = false;   ///< The robot runs, and the line is there.
    bool dropped = false;  ///< It was lost, or an e-stop is in force that this output obeys.
  };

  /// One tick. True: the safe value counts, whatever is commanded.
  [[nodiscard]] bool step(const Command& command, const Line& line, MonotonicTime now) noexcept {
    if (!command.safe || !asked_) asked_ = now;
    if (line.dropped) held_ = true;
    const bool let_go = now - *asked_ >= kLetGo;
    if (line.usable && (let_go || (command.given && command.safe))) held_ = false;
    return held_;
  }

 private:
  bool held_ = true;
  std::optional<MonotonicTime> asked_;  ///< Last commanded otherwise than safe, or the start.
};

}  // namespace rc10
