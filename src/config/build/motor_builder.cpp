#include "config/build/motor_builder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "config/build/fallback_builder.hpp"
#include "config/build/family_keys.hpp"
#include "config/build/guard_builder.hpp"
#include "config/build/loop_builder.hpp"
#include "config/build/motor_parse.hpp"
#include "config/build/reduced_builder.hpp"
#include "config/build/shaping_builder.hpp"
#include "config/build/simulated_builder.hpp"
#include "config/keys/need_check.hpp"
#include "config/keys/value_check.hpp"
#include "config/motor_families.hpp"
#include "config/yaml/number_text.hpp"
#include "motor/geared_loops.hpp"
#include "motor/solo_motor.hpp"

namespace rc10 {
namespace {

constexpr Duration kFreshEnough = std::chrono::milliseconds{20};
constexpr int kPeriodsToStale = 4;

void readPlain(MotorParse& in) {
  in.settings.read("name", in.motor().name);
  in.settings.read("direction", in.motor().direction);
  in.settings.read("optional", in.draft.config.optional);
}

bool readModel(MotorParse& in) {
  in.motor().model = in.settings.text("model");
  const auto* entry = findFamily(in.motor().model);
  in.draft.config.family = entry != nullptr ? entry->family : nullptr;
  return entry != nullptr;
}

bool readId(MotorParse& in) {
  const auto id = in.settings.find("id");
  if (!id) return false;
  in.draft.id_place = id->place();
  in.settings.read("id", in.motor().id);
  if (in.motor().id >= in.traits.min_id && in.motor().id <= in.traits.max_id) return true;
  const bool low = in.motor().id < in.traits.min_id;
  in.problems.error(id->place(), id->path,
                    id->text() + (low ? " is below the lowest " : " is above the highest ") + in.modelName() +
                        " id " + std::to_string(low ? in.traits.min_id : in.traits.max_id) + "; use " +
                        std::to_string(in.traits.min_id) + " to " + std::to_string(in.traits.max_id));
  return false;
}

void checkKeys(MotorParse& in) {
  const bool has_loops = in.traits.host_loops != nullptr;
  const bool shares = !in.draft.config.family->busUse(in.motor()).layout.empty();
  const MotorNature nature{in.motor().model, in.traits, in.knowsItsAngle(),
                           has_loops && wantsIncremental(in.settings, *in.traits.host_loops), shares};
  checkNeeds(in.settings, kMotorSection, nature, in.problems);
  if (in.traits.hostVelocityLoop())
    checkNeeds(in.settings.section("velocity_pid"), kVelocityPidSection, nature, in.problems);
}

void readEffortLimit(MotorParse& in) {
  const char* key = in.effortKey();
  const float full_scale = in.traits.effort_full_scale;
  in.settings.read(key, in.motor().effort_limit);
  const auto given = in.settings.find(key);
  if (!given || in.motor().effort_limit <= full_scale) return;
  const std::string most = numberText(full_scale);
  in.problems.error(given->place(), given->path,
                    given->text() + " is above the " + in.modelName() + " limit of " + most +
                        "; use more than 0, at most " + most);
}

void readZero(MotorParse& in) {
  in.motor().zero_at_power_on = in.settings.text("zero") == "power_on";
  if (!in.knowsItsAngle()) return;
  in.settings.read("zero_deg", in.motor().zero_deg);
  const auto zero_deg = in.settings.find("zero_deg");
  if (!zero_deg || !in.motor().zero_at_power_on || in.motor().zero_deg == 0.0) return;
  in.problems.error(zero_deg->place(), zero_deg->path, "excludes zero: power_on; keep one of them");
}

void readLoops(MotorParse& in) {
  in.settings.read("velocity_limit_rpm", in.motor().velocity_limit_rpm);
  if (in.traits.host_loops == nullptr) return;
  const CascadeConfig defaults = loopsBehindGear(*in.traits.host_loops, driveTurns(in.motor(), in.traits));
  in.motor().loops = buildLoops(in.settings, defaults, in.byVoltage());
  in.motor().velocity_limit_rpm = in.motor().loops.velocity_limit_rpm;
}

std::string millisecondsText(Duration time) {
  return numberText(std::round(std::chrono::duration<double, std::micro>(time).count()) / 1000.0) + " ms";
}

// One lost answer is no restart.
void checkCommandSpacing(MotorParse& in) {
  const Duration silence = in.traits.restart_silence;
  const Duration period = periodOf(in.motor().tick_hz);
  const auto spacing = in.motor().command_divider * period;
  // The answer after the lost one may be late by a tick.
  if (silence <= Duration::zero() || 2 * spacing + period <= silence) return;
  const auto most = (silence / period - 1) / 2;
  std::string remedy = "use at most " + std::to_string(most);
  if (most < 1) {
    remedy = "raise scheduler.rate_hz";
    if (const auto key = in.traits.silence_key; !key.empty())
      remedy += ", or " + std::string{key} + " here and on the drive";
  }
  const auto given = in.settings.find("command_divider");
  in.problems.error(given ? given->place() : in.draft.config.place, given ? given->path : in.draft.path,
                    (given ? given->text() : "command_divider 1, the default,") + " asks the drive every " +
                        millisecondsText(spacing) +
                        ": with one answer lost it is silent for so long that it may have restarted or "
                        "turned unseen (" +
                        millisecondsText(silence) + "); " + remedy);
}

void readRates(MotorParse& in) {
  in.settings.read("command_divider", in.motor().command_divider);
  checkCommandSpacing(in);
  in.motor().feedback_hz =
      in.traits.asked
          ? std::max(1, in.motor().tick_hz / (in.motor().command_divider * in.traits.samples_every))
          : in.traits.feedback_hz;
  in.settings.read("feedback_hz", in.motor().feedback_hz);
  const auto period = periodOf(in.motor().feedback_hz);
  in.draft.config.feedback_timeout = std::max<Duration>(kFreshEnough, kPeriodsToStale * period);
  if (const auto timeout = in.settings.number("feedback_timeout_ms")) {
    in.draft.config.feedback_timeout = std::chrono::milliseconds{static_cast<int>(*timeout)};
  }
  const auto given = in.settings.find("feedback_hz");
  if (!given || (in.motor().feedback_hz >= in.traits.min_feedback_hz &&
                 in.motor().feedback_hz <= in.traits.max_feedback_hz))
    return;
  const bool low = in.motor().feedback_hz < in.traits.min_feedback_hz;
  in.problems.error(given->place(), given->path,
                    given->text() + (low ? " is below " : " is above ") +
                        std::to_string(low ? in.traits.min_feedback_hz : in.traits.max_feedback_hz) +
                        " Hz; use " + std::to_string(in.traits.min_feedback_hz) + " to " +
                        std::to_string(in.traits.max_feedback_hz) + " Hz");
}

void checkFeedback(MotorParse& in) {
  const auto period = periodOf(in.motor().feedback_hz);
  const auto given = in.settings.find("feedback_timeout_ms");
  if (!given || in.draft.config.feedback_timeout >= 2 * period) return;
  const int rate_hz = in.motor().feedback_hz;
  in.problems.error(given->place(), given->path,
                    given->text() + " ms is less than two periods of feedback at " + std::to_string(rate_hz) +
                        " Hz; use at least " + std::to_string((2000 + rate_hz - 1) / rate_hz) + " ms");
}

void checkVelocityLimit(MotorParse& in) {
  const auto given = in.settings.find("velocity_limit_rpm");
  const double no_load_rpm = in.noLoadRpm();
  const bool known = in.traits.no_load_rpm > 0.0F;
  if (!given || !known || in.settings.number("velocity_limit_rpm").value_or(0.0) <= no_load_rpm) return;
  in.problems.warning(given->place(), given->path,
                      given->text() + " rpm is more than the " + in.modelName() +
                          " reaches without load at " + numberText(in.traits.nominal_v) + " V (" +
                          numberText(std::round(no_load_rpm)) + " rpm)");
}

void build(MotorParse& in, int tick_hz) {
  in.motor().tick_hz = tick_hz;
  readPlain(in);
  readSimulated(in);
  if (!readModel(in)) return;
  const bool own_known = readOwnKeys(in);
  in.traits = in.draft.config.traits();
  in.settings.read("gear_ratio", in.motor().gear_ratio);
  readDriveId(in);
  in.draft.complete = readId(in) && own_known && checkOwnKeys(in);
  if (!in.draft.complete) return;
  checkKeys(in);
  readEffortLimit(in);
  readZero(in);
  readLoops(in);
  readRates(in);
  checkFeedback(in);
  checkVelocityLimit(in);
  readGuard(in);
  readFallbacks(in);
  readShaping(in);
  readReduced(in);
}

}  // namespace

MotorDraft buildMotor(const Settings& settings, const SourcePlace& place, const std::string& path,
                      int tick_hz, Problems& problems) {
  MotorDraft draft;
  draft.config.place = place;
  draft.path = path;
  MotorParse in{settings, draft, problems};
  build(in, tick_hz);
  return draft;
}

}  // namespace rc10
