#include "config/keys/loop_gains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "app/nearest.hpp"
#include "config/keys/key_check.hpp"
#include "config/keys/need_check.hpp"
#include "config/keys/value_check.hpp"
#include "config/yaml/number_text.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {
namespace {

using enum LoopGain;

constexpr std::string_view kVelocity = "velocity_pid";
constexpr std::string_view kAngle = "angle_pid";
// Optional in requests: "velocity.kp".
constexpr std::string_view kSuffix = "_pid";

struct Naming {
  std::string_view loop;
  std::string_view key;
  std::string_view brief;
  LoopGain gain;
};

constexpr std::array kNamings{
    Naming{kVelocity, "kp_a_per_rpm", "kp", kVelocityKp},
    Naming{kVelocity, "ki_a_per_rpm_s", "ki", kVelocityKi},
    Naming{kVelocity, "kd_a_s_per_rpm", "kd", kVelocityKd},
    Naming{kVelocity, "kp_v_per_rpm", "kp", kVelocityKp},
    Naming{kVelocity, "ki_v_per_rpm_s", "ki", kVelocityKi},
    Naming{kVelocity, "kd_v_s_per_rpm", "kd", kVelocityKd},
    Naming{kVelocity, "deadband_rpm", "deadband", kVelocityDeadband},
    Naming{kVelocity, "derivative_filter_hz", "derivative_filter", kVelocityDerivativeFilter},
    Naming{kVelocity, "integral_limit_a", "integral_limit", kVelocityIntegralLimit},
    Naming{kVelocity, "integral_limit_v", "integral_limit", kVelocityIntegralLimit},
    Naming{kVelocity, "integral_separation_rpm", "integral_separation", kVelocityIntegralSeparation},
    Naming{kVelocity, "target_bandwidth_rad_s", "target_bandwidth", kVelocityTargetBandwidth},
    Naming{kAngle, "kp_rpm_per_deg", "kp", kAngleKp},
    Naming{kAngle, "ki_rpm_per_deg_s", "ki", kAngleKi},
    Naming{kAngle, "kd_rpm_s_per_deg", "kd", kAngleKd},
    Naming{kAngle, "deadband_deg", "deadband", kAngleDeadband},
    Naming{kAngle, "velocity_limit_rpm", "velocity_limit", kAngleVelocityLimit},
    Naming{kAngle, "integral_limit_rpm", "integral_limit", kAngleIntegralLimit},
    Naming{kAngle, "integral_separation_deg", "integral_separation", kAngleIntegralSeparation},
    Naming{kAngle, "derivative_filter_hz", "derivative_filter", kAngleDerivativeFilter}};

const Section& sectionOf(std::string_view loop) {
  return loop == kVelocity ? kVelocityPidSection : kAnglePidSection;
}

MotorNature natureOf(const MotorLoops& loops) {
  return {.model = loops.model,
          .traits = loops.traits,
          .incremental = std::holds_alternative<PID_Incremental::Config>(loops.config.velocity)};
}

std::uint16_t unmetNeeds(const Key& key, const MotorLoops& loops) {
  return static_cast<std::uint16_t>(key.needs & ~natureOf(loops).metNeeds());
}

bool closed(std::string_view loop, const MotorLoops& loops) {
  return loop == kVelocity ? loops.traits.hostVelocityLoop() : loops.onHost();
}

constexpr std::string_view kAtStartOnly =
    "is read at the start only; change it in the robot's file and restart rc10d";

/// "velocity" and "velocity_pid" mean the loop velocity_pid; empty: there is none of that name.
std::string_view loopNamed(std::string_view name) {
  for (const auto loop : {kVelocity, kAngle}) {
    if (name == loop || name == loop.substr(0, loop.size() - kSuffix.size())) return loop;
  }
  return {};
}

/// Gain as requested: of one loop, or by its key in whichever loop has it.
struct Asked {
  std::string_view name;
  std::string_view loop;  ///< Empty: not said.
  std::string_view key;

  [[nodiscard]] bool means(const GainKey& gain) const {
    if (loop.empty()) return key == gain.key->name;
    return loop == gain.loop && (key == gain.key->name || key == gain.brief);
  }
};

Result<Asked> asked(std::string_view name) {
  const auto dot = name.find('.');
  if (dot == std::string_view::npos) return Asked{name, {}, name};
  const auto loop = loopNamed(name.substr(0, dot));
  if (!loop.empty()) return Asked{name, loop, name.substr(dot + 1)};
  return fail(excerpt(name) + ": there is no loop " + inQuotes(name.substr(0, dot)) +
              "; use velocity_pid or angle_pid" +
              didYouMean(name.substr(0, dot), {kVelocity, kAngle, "velocity", "angle"}));
}

std::string whyUnknown(const Asked& asked, const MotorLoops& loops) {
  const bool of_motor = asked.loop.empty() && findKey(kMotorSection, asked.key) != nullptr;
  const bool of_loop = !asked.loop.empty() && findKey(sectionOf(asked.loop), asked.key) != nullptr;
  if (of_motor || of_loop) return std::string{kAtStartOnly};
  std::vector<std::string> written;
  std::vector<std::string_view> names;
  std::vector<std::string_view> briefs;
  for (const auto& gain : gainKeysOf(loops)) {
    if (!asked.loop.empty() && asked.loop != gain.loop) continue;
    names.push_back(gain.key->name);
    briefs.push_back(gain.brief);
    written.push_back(asked.loop.empty() ? gain.path() : std::string{gain.key->name});
  }
  const std::vector<std::string_view> listed{written.begin(), written.end()};
  // "velocity.kpp": a brief name is one with a loop.
  const bool is_brief = !asked.loop.empty() && nearest(asked.key, names).empty();
  return unknownKeyWords(asked.key, is_brief ? briefs : names, listed);
}

/// The one gain of this motor that is meant.
Result<GainKey> gainMeant(const Asked& asked, const MotorLoops& loops) {
  std::vector<GainKey> meant;
  std::vector<GainKey> usable;
  for (const auto& gain : allGainKeys()) {
    if (!asked.means(gain)) continue;
    meant.push_back(gain);
    if (closed(gain.loop, loops) && unmetNeeds(*gain.key, loops) == 0) usable.push_back(gain);
  }
  const auto why = [&](const std::string& reason) { return fail(excerpt(asked.name) + ": " + reason); };
  // At the motor itself velocity_limit_rpm is a limit, which no gain may pass.
  if (asked.loop.empty() && !meant.empty() && findKey(kMotorSection, asked.key) != nullptr)
    return why(std::string{kAtStartOnly} + "; or write " + meant.front().path());
  if (meant.empty()) return why(whyUnknown(asked, loops));
  if (usable.size() == 1) return usable.front();
  if (usable.size() > 1)
    return why("is in both loops; write " + usable[0].path() + " or " + usable[1].path());
  if (!closed(meant.front().loop, loops))
    return why("the " + loops.model + " closes its velocity loop itself; only gains of angle_pid can be set");
  return why(whyMeaningless(*meant.front().key, unmetNeeds(*meant.front().key, loops), natureOf(loops)));
}

std::string lineOf(std::string_view loop, const MotorLoops& loops) {
  const bool incremental = std::holds_alternative<PID_Incremental::Config>(loops.config.velocity);
  std::string text;
  if (loop == kVelocity) text = incremental ? "type: incremental" : "type: position";
  for (const auto& gain : gainKeysOf(loops)) {
    const float value = gainOf(loops.config, gain.gain);
    // No limit is a limit that is not written.
    if (gain.loop != loop || !whyOutOfRange(static_cast<double>(value), *gain.key).empty()) continue;
    text += (text.empty() ? "" : ", ") + std::string{gain.key->name} + ": " + numberText(value);
  }
  return std::string{loop} + ": {" + text + "}";
}

}  // namespace

const std::vector<GainKey>& allGainKeys() {
  static const std::vector<GainKey> kKeys = [] {
    std::vector<GainKey> keys;
    for (const auto& naming : kNamings) {
      if (const Key* key = findKey(sectionOf(naming.loop), naming.key))
        keys.push_back({naming.gain, naming.loop, naming.brief, key});
    }
    return keys;
  }();
  return kKeys;
}

std::vector<GainKey> gainKeysOf(const MotorLoops& loops) {
  std::vector<GainKey> keys;
  for (const auto& gain : allGainKeys()) {
    if (closed(gain.loop, loops) && unmetNeeds(*gain.key, loops) == 0) keys.push_back(gain);
  }
  return keys;
}

Result<GainChange> gainChange(std::string_view name, double value, const MotorLoops& loops) {
  const auto wanted = asked(name);
  if (!wanted) return tl::unexpected(wanted.error());
  const auto gain = gainMeant(*wanted, loops);
  if (!gain) return tl::unexpected(gain.error());
  if (!std::isfinite(value)) return fail(gain->path() + ": is not a finite number");
  // 0, as shown where the file has no limit of the loop: the motor's own limit alone.
  if (gain->gain == kAngleVelocityLimit && value == 0.0) return GainChange{gain->gain, 0.0F};
  if (auto reason = whyOutOfRange(value, *gain->key); !reason.empty())
    return fail(gain->path() + ": " + reason);
  return GainChange{gain->gain, static_cast<float>(value)};
}

std::string gainLines(const MotorLoops& loops) {
  std::string text;
  for (const auto loop : {kVelocity, kAngle}) {
    if (closed(loop, loops)) text += (text.empty() ? "" : "\n") + lineOf(loop, loops);
  }
  return text;
}

}  // namespace rc10
