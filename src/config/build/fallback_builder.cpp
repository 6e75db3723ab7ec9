#include "config/build/fallback_builder.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "config/keys/value_check.hpp"
#include "motor/guarding/fallback.hpp"

namespace rc10 {
namespace {

[[nodiscard]] FallbackAction fallbackOf(MotorParse& in, std::string_view key) {
  const auto word = std::find(kFallbackWords.begin(), kFallbackWords.end(), in.settings.text(key));
  if (word == kFallbackWords.end()) return FallbackAction::kCoast;
  return static_cast<FallbackAction>(word - kFallbackWords.begin());
}

[[nodiscard]] bool able(const MotorParse& in, FallbackAction action) {
  if (action == FallbackAction::kRamp) return in.traits.modes.contains(ControlMode::kVelocity);
  return in.traits.frames.of(frameKindOf(action)) != Provision::kUnsupported;
}

// After on_timeout a motor stays enabled: a ramp ends in its idle, which has torque in some modes.
[[nodiscard]] bool restsAfter(const MotorParse& in, std::string_view key, FallbackAction action) {
  return action != FallbackAction::kRamp || key != "on_timeout" || in.traits.frames.idle_rests;
}

void checkFallback(MotorParse& in, std::string_view key) {
  const auto given = in.settings.find(key);
  if (!given) return;
  const auto asked = fallbackOf(in, key);
  const bool can = able(in, asked);
  if (can && restsAfter(in, key, asked)) return;
  std::vector<std::string> possible;
  for (std::size_t i = 0; i < kFallbackWords.size(); ++i) {
    const auto action = static_cast<FallbackAction>(i);
    if (able(in, action) && restsAfter(in, key, action)) possible.emplace_back(kFallbackWords[i]);
  }
  const std::string why =
      can ? "a ramp ends in no torque, but the " + in.modelName() +
                " set so stands still with its own torque while it is enabled without a target"
          : "the " + in.modelName() + " cannot " + given->text() + " by itself";
  in.problems.error(given->place(), given->path, why + "; use " + listWords(possible, " or "));
}

void readSeconds(MotorParse& in, std::string_view key, Duration& time) {
  const auto given_s = in.settings.number(key);
  if (given_s) time = std::chrono::milliseconds{static_cast<std::int64_t>(*given_s * 1000.0)};
}

}  // namespace

void readFallbacks(MotorParse& in) {
  FallbackConfig& fallback = in.draft.config.fallback;
  fallback.on_timeout = fallbackOf(in, "on_timeout");
  fallback.on_disable = fallbackOf(in, "on_disable");
  fallback.on_estop = fallbackOf(in, "on_estop");
  for (const auto* key : {"on_timeout", "on_disable", "on_estop"}) checkFallback(in, key);
  readSeconds(in, "hold_max_s", fallback.hold_max);
  readSeconds(in, "brake_max_s", fallback.brake_max);
  readSeconds(in, "ramp_s", fallback.ramp);
  readSeconds(in, "run_down_s", in.draft.config.run_down);
}

}  // namespace rc10
