#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "app/result.hpp"

namespace rc10::link {

/// The one message of rc10d to rc10-guard: a line `rc10-guard VERSION ROBOT STANDSTILL_MS`, and behind it the
/// rest frames (bus/frame_text.hpp). With it come, in this order, the page and a pidfd of rc10d. The guard
/// answers kGuardArmed, or in words why it does not watch.
struct GuardHello {
  static constexpr int kVersion = 1;

  std::string robot;
  std::uint32_t standstill_ms = 0;  ///< Silence of ticks at which rc10d stands still. Range 1 to 60,000.
  std::string rest_frames;
};

inline constexpr std::string_view kGuardArmed = "armed";

[[nodiscard]] std::string guardHelloText(const GuardHello& hello);
/// The error says what is wrong.
[[nodiscard]] Result<GuardHello> parseGuardHello(std::string_view text);

}  // namespace rc10::link
