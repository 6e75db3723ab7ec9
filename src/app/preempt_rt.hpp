#pragma once

#include <string_view>

namespace rc10 {

/// Whether a kernel is PREEMPT_RT, from its files: those with the patch have /sys/kernel/realtime, those of
/// mainline say it in /proc/sys/kernel/version only. Empty: the file is not there.
[[nodiscard]] constexpr bool isPreemptRt(std::string_view realtime, std::string_view version) noexcept {
  return realtime.substr(0, 1) == "1" || version.find("PREEMPT_RT") != std::string_view::npos;
}

}  // namespace rc10
