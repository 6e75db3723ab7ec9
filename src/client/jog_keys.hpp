#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/time.hpp"

namespace rc10::client {

enum class JogKey : std::uint8_t { kForward, kBackward, kFaster, kSlower, kStop, kQuit };

/// Makes keys of what a terminal sends. The bytes of one key may come in two parts; then the first is a stop,
/// for an instant, as the key ESC is.
class JogKeys {
 public:
  [[nodiscard]] std::vector<JogKey> take(std::string_view bytes);

 private:
  std::string begun_;  // the beginning of an arrow key
};

/// The speed that the keys ask for. A motor turns only as long as keys come: a terminal repeats one that is
/// held.
class JogSpeed {
 public:
  /// `dead_man`: time from the last key until the motor stands.
  JogSpeed(double speed_rpm, double most_rpm, Duration dead_man)
      : speed_rpm_(std::min(speed_rpm, most_rpm)), most_rpm_(most_rpm), dead_man_(dead_man) {}

  /// The keys of one look at the terminal, many times a second. After a pause of the program it has those
  /// that were held during it, which say nothing of the present: they do not turn the motor.
  void press(const std::vector<JogKey>& keys, MonotonicTime now);
  /// Present target of the motor, rpm.
  [[nodiscard]] double target(MonotonicTime now) const;
  /// The speed of the arrow keys, rpm.
  [[nodiscard]] double speed() const noexcept { return speed_rpm_; }

 private:
  void pressOne(JogKey key, MonotonicTime now);

  double speed_rpm_;
  double most_rpm_;
  Duration dead_man_;
  int direction_ = 0;
  std::optional<MonotonicTime> pressed_;
  std::optional<MonotonicTime> looked_;
};

}  // namespace rc10::client
