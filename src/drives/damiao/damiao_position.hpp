#pragma once

#include <cstdint>

#include "app/time.hpp"
#include "drives/damiao/damiao_model.hpp"

namespace rc10 {

/// Where a Damiao drive thinks it is. It counts on over turns in a float, takes its targets by that count,
/// and reports it in 16 bits that wrap at +-p_max: which of the wraps is the present one only its register
/// "xout" tells. A p_max of 12.5 rad is not a whole number of turns, so without that even the angle within a
/// turn is unknown. Scheduler thread only.
class DamiaoPosition {
 public:
  enum class Step : std::uint8_t {
    kFollows,
    kLost,    ///< After a gap in which it may have wrapped unseen.
    kJumped,  ///< Farther than the motor can have turned: the drive was restarted, or its encoder slipped.
  };

  /// `fastest_rad_s`: of the drive's output, and some more. `period`: of its feedback.
  DamiaoPosition(const DamiaoScale& scale, double fastest_rad_s, Duration period) noexcept;

  /// After a longer one it may have wrapped unseen.
  [[nodiscard]] static Duration longestSilence(const DamiaoScale& scale, double fastest_rad_s) noexcept;

  /// The position in feedback. Unless it follows, the wrap is unknown from now on.
  Step take(std::uint16_t code, MonotonicTime received) noexcept;

  enum class Wrap : std::uint8_t { kSame, kOther, kContradiction };
  /// Evaluates the register, after take(). kOther: rad() has changed by whole wraps.
  Wrap take(float register_rad) noexcept;

  /// The drive may have been restarted.
  void forget() noexcept;

  /// Whether rad() is the drive's own count.
  [[nodiscard]] bool known() const noexcept { return known_; }
  /// Goes on over wraps as long as it follows.
  [[nodiscard]] double rad() const noexcept;

 private:
  DamiaoScale scale_;
  double fastest_rad_s_;
  Duration period_;
  Duration longest_silence_;
  double step_rad_;
  bool begun_ = false;
  bool known_ = false;
  std::int64_t code_ = 0;  ///< Wraps counted.
  MonotonicTime received_{};
};

}  // namespace rc10
