#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "daemon/devices/gpio_lines.hpp"
#include "daemon/devices/line_bank.hpp"
#include "daemon/devices/retry_pace.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/note.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/tick/scheduler.hpp"

namespace rc10 {

/// The lines thread: reads and drives the GPIO lines of modules, so that the scheduler never waits for a
/// chip, and the e-stop input, which has a thread of its own, does not either.
class LineLoop {
 public:
  /// Period at which inputs are read.
  static constexpr Duration kLookInterval = std::chrono::milliseconds{1};
  /// Outputs alone need no looks; a silent scheduler must be noticed all the same.
  static constexpr Duration kIdleInterval = std::chrono::milliseconds{20};
  /// Silence of ticks after which outputs go to their safe values. In this thread's own turns, so that a
  /// computer that stood still as a whole is no silence.
  static constexpr Duration kMaxSilence = std::chrono::milliseconds{200};
  /// So many bad turns in a row, and the lines are given back. A disturbance of an I2C bus (a valve or a
  /// motor that switches) spoils one or two; letting go for that would drop what a valve holds. A chip that
  /// is gone is noticed within 5 ms all the same, and meanwhile every output is tried again in every turn.
  static constexpr int kMaxBadTurns = 5;
  /// Period at which a chip that fails now and then is reported, with its count of failures.
  static constexpr Duration kTellBadTurns = std::chrono::seconds{1};

  LineLoop(LineBanks& banks, std::unique_ptr<GpioSystem> gpio, LinkExchange& exchange);

  /// The thread's body. At the end every output is at its safe value.
  void run(const std::stop_token& stop, const Scheduler& scheduler);
  /// Drives and reads every line once. `ticks`: of the scheduler, so far.
  void turn(MonotonicTime now, std::uint64_t ticks);
  /// Safe values, and the lines are let go.
  void end() noexcept;

 private:
  struct Bank {
    std::vector<std::unique_ptr<DigitalInput>> inputs{};
    std::vector<std::unique_ptr<DigitalOutput>> outputs{};
    bool held = false;            ///< The lines are this process's.
    bool answers = false;         ///< And there was a good turn.
    std::uint32_t driven = 0;     ///< Levels that the outputs took.
    std::uint32_t unwritten = 0;  ///< Outputs that refused theirs.
    int bad_turns = 0;            ///< In a row.
    std::uint64_t failures = 0;   ///< Bad turns that were not told yet.
    std::optional<MonotonicTime> failures_told{};
    MonotonicTime refreshed{};
    RetryPace pace{};
  };

  void watchScheduler(MonotonicTime now, std::uint64_t ticks);
  void tryToOpen(std::size_t index, MonotonicTime now);
  [[nodiscard]] Result<void> open(LineBank& bank, Bank& lines);
  /// `all`: also unchanged levels. Refused ones are in `unwritten`, and tried again the next time.
  static void drive(Bank& lines, std::uint32_t levels, bool all) noexcept;
  [[nodiscard]] static std::optional<std::uint32_t> read(Bank& lines) noexcept;
  void work(std::size_t index, MonotonicTime now);
  void goodTurn(std::size_t index, MonotonicTime now);
  void badTurn(std::size_t index, bool unread, MonotonicTime now);
  void lose(std::size_t index, MonotonicTime now);
  [[nodiscard]] Duration interval() const noexcept;

  LineBanks& banks_;
  std::unique_ptr<GpioSystem> gpio_;
  Notes notes_;
  std::vector<Bank> lines_;
  Duration interval_;
  std::optional<MonotonicTime> last_turn_;
  std::uint64_t last_ticks_ = 0;
  Duration silence_{};
};

}  // namespace rc10
