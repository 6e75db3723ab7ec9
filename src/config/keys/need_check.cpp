#include "config/keys/need_check.hpp"

namespace rc10 {

std::string whyMeaningless(const Key& key, std::uint16_t unmet, const MotorNature& nature) {
  const std::string model{nature.model};
  const std::string use_twin = "; use " + std::string{key.twin};
  if ((unmet & kNeedsCurrent) != 0)
    return "with command: voltage the " + model + " is commanded in volts" + use_twin;
  if ((unmet & kNeedsVoltage) != 0) {
    const bool chosen = nature.traits.host_loops != nullptr;
    return (chosen ? "with command: current the " : "the ") + model + " is commanded in amperes" + use_twin;
  }
  if ((unmet & kNeedsHostLoops) != 0) return "the " + model + " has loops of its own; remove it";
  if ((unmet & kNeedsHostVelocity) != 0)
    return "the " + model + " closes its velocity loop itself, and only angle_pid acts; remove it";
  if ((unmet & kNeedsUnasked) != 0) return "the " + model + " sends nothing but answers; use command_divider";
  if ((unmet & kNeedsOwnFrames) != 0)
    return "the " + model + " shares its command frames with other motors; remove it";
  if ((unmet & kNeedsIncremental) != 0) return "belongs to type: incremental; remove it, or change the type";
  if ((unmet & kNeedsPosition) != 0) return "belongs to type: position; remove it, or change the type";
  if ((unmet & kNeedsTemperature) != 0) return "the " + model + " reports no temperature; remove it";
  if ((unmet & kNeedsSignedCurrent) != 0)
    return "the " + model + ", as it is configured, reports no current with a sign; remove it";
  if ((unmet & kNeedsScaledSpeed) != 0)
    return "the " + model + " does not report its speed as a share of a range; remove it";
  if ((unmet & kNeedsAngle) != 0)
    return "the " + model +
           ", as it is configured, reports no angle; remove it, or choose another value of angle";
  if ((unmet & kNeedsSeenLimit) != 0)
    return "needs to see when the current is at its limit, which the " + model +
           ", as it is configured, does not show: " + std::string{nature.traits.unseen_limit_remedy} +
           ", or remove it";
  if ((unmet & kNeedsToldLimit) != 0)
    return "the " + model +
           ", as it is configured, is told no limit of its current; choose another value of control, or "
           "remove it";
  const std::string geared = nature.traits.absolute ? " behind a gear" : "";
  return "the " + model + geared + " does not know its output angle at power-up" + use_twin;
}

std::uint16_t MotorNature::metNeeds() const noexcept {
  unsigned met = traits.effort == CommandUnit::kVolt ? kNeedsVoltage : kNeedsCurrent;
  met |= incremental ? kNeedsIncremental : kNeedsPosition;
  if (traits.reports_temperature) met |= kNeedsTemperature;
  if (traits.signed_a > 0.0F) met |= kNeedsSignedCurrent;
  if (traits.scaled_speed) met |= kNeedsScaledSpeed;
  if (traits.reports_angle) met |= kNeedsAngle;
  if (traits.unseen_limit_remedy.empty()) met |= kNeedsSeenLimit;
  if (traits.bounds_effort) met |= kNeedsToldLimit;
  if (absolute) met |= kNeedsAbsolute;
  if (traits.host_loops != nullptr) met |= kNeedsHostLoops;
  if (traits.hostVelocityLoop()) met |= kNeedsHostVelocity;
  if (!traits.asked) met |= kNeedsUnasked;
  if (!shares_frames) met |= kNeedsOwnFrames;
  return static_cast<std::uint16_t>(met);
}

void checkNeeds(const Settings& given, const Section& section, const MotorNature& nature,
                Problems& problems) {
  for (const Key& key : section.keys()) {
    const auto unmet = static_cast<std::uint16_t>(key.needs & ~nature.metNeeds());
    const auto value = unmet != 0 ? given.find(key.name) : std::nullopt;
    if (value) problems.error(value->place(), value->path, whyMeaningless(key, unmet, nature));
  }
}

}  // namespace rc10
