#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "app/time.hpp"
#include "drives/robstride/robstride_frames.hpp"
#include "motor/enable_sequence.hpp"

namespace rc10 {

/// A parameter to be set before a drive is enabled.
struct RobstrideSetting {
  std::uint16_t index = 0;
  std::uint32_t bits = 0;
  /// A float of which the drive may keep less: a limit, cut down to the model's own.
  bool at_most = false;
  /// A reference or a limit that goes on being written: its value is no longer that of here.
  bool rewritten = false;

  [[nodiscard]] static RobstrideSetting limit(std::uint16_t index, float value) noexcept;
  [[nodiscard]] bool agrees(std::uint32_t read_bits) const noexcept;
};

/// The way to a running drive, one step at a time: stop it, write each setting and read it back, read its
/// position if that is wanted, enable. A frame without an answer within 50 ms is sent again, at most 5 times.
/// Scheduler thread only.
class RobstrideEnabling {
 public:
  static constexpr std::size_t kMaxSettings = 5;

  RobstrideEnabling() noexcept;

  /// Start-up only.
  void add(const RobstrideSetting& setting) noexcept;
  /// Start-up only.
  void readPosition() noexcept { reads_position_ = true; }
  void begin() noexcept;
  [[nodiscard]] SequenceProgress progress() const noexcept { return sequence_.progress(); }

  /// The frames that are due now, at most 3. `operation`: tell it to be without torque before and after
  /// it is enabled, whatever it was last told.
  std::size_t pack(MonotonicTime now, const robstride::Codec& codec, bool operation,
                   std::span<CanFrame> out) noexcept;
  void onFeedback(const robstride::Feedback& seen) noexcept;
  /// The answer to any question: a setting that no longer reads as it was confirmed fails the sequence, also
  /// after its end.
  void onParameter(std::uint16_t index, bool accepted, std::uint32_t bits) noexcept;
  /// Index of that setting.
  [[nodiscard]] std::optional<std::uint16_t> culprit() const noexcept { return culprit_; }
  void forgive() noexcept { culprit_.reset(); }

 private:
  [[nodiscard]] bool atSetting() const noexcept { return step() >= 1 && step() <= count_; }
  [[nodiscard]] bool atPosition() const noexcept { return reads_position_ && step() == count_ + 1; }
  [[nodiscard]] bool atEnable() const noexcept { return step() == count_ + (reads_position_ ? 2 : 1); }
  [[nodiscard]] std::size_t step() const noexcept { return sequence_.step(); }
  void advance() noexcept;
  [[nodiscard]] bool contradicts(std::uint16_t index, std::uint32_t bits) const noexcept;

  std::array<RobstrideSetting, kMaxSettings> settings_{};
  std::size_t count_ = 0;
  bool reads_position_ = false;
  std::optional<std::uint16_t> culprit_;
  EnableSequence<std::size_t> sequence_;  ///< 0: stop; then the settings, the position, enable.
};

}  // namespace rc10
