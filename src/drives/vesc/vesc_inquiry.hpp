#pragma once

#include <cstdint>
#include <optional>

#include "app/time.hpp"
#include "drives/vesc/vesc_frames.hpp"
#include "motor/drive_frames.hpp"

namespace rc10 {

/// Questions to a VESC about state that its status frames lack: its fault, its kill switch, and whether
/// its watchdog works. The watchdog is proven once after each start of the drive: a motor at rest, which has
/// said that it hears its commands, is told nothing until it says that it has timed out. A time-out from
/// before proves nothing: any watchdog trips in a drive that nobody commands. Pure: frames and time come in,
/// questions go out. Scheduler thread only.
class VescInquiry {
 public:
  /// `silent_for`: how long a drive is told nothing to see its watchdog.
  explicit VescInquiry(Duration silent_for) noexcept : silent_for_(silent_for) {}

  /// Once in each tick, before packing.
  void update(const Tick& tick, FrameKind ordered) noexcept;
  void take(const vesc::Answer& answer) noexcept;
  /// A command goes to the drive.
  void told() noexcept { told_ = true; }
  /// A status frame of the drive, which nobody asks for.
  void spoke() noexcept { spoke_ = true; }
  /// The drive was restarted, or may be another one: all is to be found out anew.
  void restart() noexcept;

  /// Question of this tick; 0: none.
  [[nodiscard]] std::uint32_t question() const noexcept { return question_; }
  /// The drive is to be told nothing, so that its watchdog can be seen.
  [[nodiscard]] bool silence() const noexcept { return silent_; }
  [[nodiscard]] SequenceProgress progress() const noexcept { return progress_; }
  [[nodiscard]] std::uint8_t fault() const noexcept { return fault_; }
  [[nodiscard]] bool killed() const noexcept { return (status_ & vesc::kKillSwitch) != 0; }
  /// It has not heard the commands that it was sent all the time: it says so, or speaks and answers nothing.
  [[nodiscard]] bool deaf() const noexcept;
  [[nodiscard]] bool watchdogProven() const noexcept { return proof_ == Proof::kProven; }

 private:
  enum class Proof : std::uint8_t { kOpen, kProven, kRefuted };
  /// The watchdog is to be seen, and the drive answers and need not obey.
  [[nodiscard]] bool proving() const noexcept;
  void watchSilence(const Tick& tick) noexcept;
  void enable() noexcept;
  void ask(const Tick& tick) noexcept;

  Duration silent_for_;
  FrameKind ordered_ = FrameKind::kRest;
  MonotonicTime ordered_since_;  ///< To obey, or to rest; and it has answered.
  MonotonicTime asked_;
  MonotonicTime silent_since_;
  std::optional<MonotonicTime> heard_us_at_;  ///< Its last answer was that it has not timed out.
  MonotonicTime now_;
  std::uint32_t question_ = 0;
  std::uint32_t pending_ = 0;  ///< Asked, not yet answered.
  std::uint32_t next_ = vesc::kAskStatus;
  int unanswered_ = 0;
  int ignored_ = 0;          ///< Questions since its last answer after which it spoke.
  std::uint32_t fresh_ = 0;  ///< Answers since the enabling began.
  Proof proof_ = Proof::kOpen;
  bool begun_ = false;
  bool heard_ = false;  ///< It has answered since it was (re)started.
  bool told_ = false;   ///< It was sent a command since then.
  bool spoke_ = false;  ///< Since the last question.
  bool silent_ = false;
  bool deaf_ = false;
  std::uint8_t fault_ = 0;
  std::uint8_t status_ = 0;
  SequenceProgress progress_ = SequenceProgress::kPending;
};

}  // namespace rc10
