#include "client/jog_keys.hpp"

#include <algorithm>

namespace rc10::client {
namespace {

constexpr double kSpeedStep = 1.25;
constexpr double kLeastRpm = 0.5;
constexpr Duration kPause = std::chrono::milliseconds{100};

std::optional<JogKey> arrow(char last) {
  switch (last) {
    case 'A': return JogKey::kFaster;
    case 'B': return JogKey::kSlower;
    case 'C': return JogKey::kForward;
    case 'D': return JogKey::kBackward;
    default: return std::nullopt;
  }
}

}  // namespace

// An arrow is ESC [ A, or ESC O A where the terminal is in application mode. Every other key stops: who hits
// the keyboard in a fright hits any key.
std::vector<JogKey> JogKeys::take(std::string_view bytes) {
  std::vector<JogKey> keys;
  for (const char byte : bytes) {
    if (begun_.size() == 2) {
      keys.push_back(arrow(byte).value_or(JogKey::kStop));
      begun_.clear();
    } else if (begun_.size() == 1 && (byte == '[' || byte == 'O')) {
      begun_ += byte;
    } else if (byte == '\x1b') {
      begun_ = byte;
    } else {
      begun_.clear();
      keys.push_back(byte == 'q' || byte == 'Q' ? JogKey::kQuit : JogKey::kStop);
    }
  }
  if (begun_ == "\x1b") keys.push_back(JogKey::kStop);
  return keys;
}

void JogSpeed::press(const std::vector<JogKey>& keys, MonotonicTime now) {
  const bool paused = looked_ && now - *looked_ > kPause;
  looked_ = now;
  for (const auto key : keys) {
    if (paused && (key == JogKey::kForward || key == JogKey::kBackward)) continue;
    pressOne(key, now);
  }
}

void JogSpeed::pressOne(JogKey key, MonotonicTime now) {
  switch (key) {
    case JogKey::kForward: direction_ = 1; break;
    case JogKey::kBackward: direction_ = -1; break;
    case JogKey::kFaster: speed_rpm_ = std::min(speed_rpm_ * kSpeedStep, most_rpm_); return;
    case JogKey::kSlower:
      speed_rpm_ = std::max(speed_rpm_ / kSpeedStep, std::min(kLeastRpm, most_rpm_));
      return;
    case JogKey::kStop:
    case JogKey::kQuit: direction_ = 0; return;
  }
  pressed_ = now;
}

double JogSpeed::target(MonotonicTime now) const {
  const bool held = pressed_ && now >= *pressed_ && now - *pressed_ < dead_man_;
  return held ? direction_ * speed_rpm_ : 0.0;
}

}  // namespace rc10::client
