#include "doctor/latency_check.hpp"

#include <array>
#include <cstdio>

namespace rc10::doctor {
namespace {

// Published cyclictest maxima under load: Raspberry Pi 4, 5.15-rt, stress for 2 h: 60 us
// (ros-realtime/ros-realtime-rpi4-image PR#68); with a busy wireless network 100 us (guysoft/RealtimePi#17).
constexpr int kGoodShare = 10;
// Half a tick late, the command of one tick comes nearer to the next one's than to its own.
constexpr int kBadShare = 2;

std::string microsText(Duration duration) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.0f us", static_cast<double>(duration.count()) / 1000.0);
  return text.data();
}

}  // namespace

Finding checkLatency(const LatencyFacts& latency) {
  const std::string what = "wake-up latency";
  std::string found = "p50 " + microsText(latency.p50) + ", p99 " + microsText(latency.p99) + ", p99.9 " +
                      microsText(latency.p999) + ", max " + microsText(latency.max);
  if (latency.wake_ups != 0) found += " of " + std::to_string(latency.wake_ups) + " wake-ups";
  found += " (" + latency.by + ")";
  const auto good = latency.period / kGoodShare;
  const auto bad = latency.period / kBadShare;
  const std::string fix =
      "see what warns above: PREEMPT_RT, governor, isolation; end other real-time programs; measure for a "
      "day: --latency-seconds 86400";
  if (!latency.realtime) {
    return warn(what, found + ", without real-time priority: " + latency.refused,
                "raise the limits (above), or run it with sudo");
  }
  if (latency.max <= good) return pass(what, found + "; good is up to " + microsText(good));
  if (latency.max <= bad) return warn(what, found + "; good is up to " + microsText(good), fix);
  return fault(what, found + "; more than half a tick, " + microsText(bad), fix);
}

}  // namespace rc10::doctor
