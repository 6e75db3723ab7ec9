#include "config/build/guard_builder.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>

#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

// Shares of the no-load speed at 24 V: above what the drive alone can reach; below a turning motor's noise.
constexpr double kOverspeed = 1.5;
constexpr double kLeastOverspeed = 1.1;  // a full battery
constexpr double kStall = 0.02;
// Against all its torque: more than a load or another robot that pushes adds.
constexpr double kRunaway = 0.1;
// A turn per second: where the no-load speed is unknown, a tenth of the user's limit may be a hand's push.
constexpr double kLeastUnknownRunawayRpm = 60.0;
// A push that is over, and the lag of a current that the drive filters.
constexpr Duration kReportedRunawayTime = std::chrono::milliseconds{100};
// Share of full scale: error of the current of a drive in order.
constexpr float kFrozen = 0.05F;
// GM6020 manual: it warns above 100 C, its winding stands 125 C; the C620 warns from 125 C.
constexpr float kDerateC = 80.0F;
constexpr float kTripC = 100.0F;
constexpr double kFollowingErrorMs = 200.0;
// Share of the largest reported current: offset and noise of its measurement stay below.
constexpr float kRest = 0.05F;
// Share of the current limit: a drive that repeats its last command may exceed it.
constexpr float kRestOfLimit = 0.5F;
constexpr Duration kRestTime = std::chrono::milliseconds{100};
constexpr Duration kFastCurrent = std::chrono::milliseconds{20};
// A report stands until the next: one alone may be of before.
constexpr int kReports = 2;

// None where the feedback ends below what the motor may turn at.
float defaultOverspeedRpm(const MotorParse& in) {
  const double rpm = std::min(kOverspeed * in.noLoadRpm(), in.highestThresholdRpm());
  return rpm > kLeastOverspeed * in.noLoadRpm() ? static_cast<float>(rpm) : 0.0F;
}

// A limit that trips on what is asked for would be of no use, nor one that no feedback reaches.
void checkOverspeed(MotorParse& in) {
  const auto given = in.settings.find("overspeed_rpm");
  if (given)
    in.refuseUnseen(*given, static_cast<double>(in.draft.config.guard.overspeed_rpm),
                    in.highestThresholdRpm());
  const float target_rpm = in.motor().velocity_limit_rpm;
  if (!given || in.draft.config.guard.overspeed_rpm > target_rpm) return;
  in.problems.error(given->place(), given->path,
                    given->text() + " rpm is not above the velocity limit of " + numberText(target_rpm) +
                        " rpm; raise it, or lower velocity_limit_rpm");
}

void checkTemperatures(MotorParse& in) {
  const GuardConfig& guard = in.draft.config.guard;
  const auto derate = in.settings.find("temperature_derate_c");
  const auto trip = in.settings.find("temperature_trip_c");
  const auto& given = trip ? trip : derate;
  if (!given || guard.temperature_derate_c < guard.temperature_trip_c) return;
  in.problems.error(given->place(), given->path,
                    "temperature_derate_c (" + numberText(guard.temperature_derate_c) +
                        ") must be below temperature_trip_c (" + numberText(guard.temperature_trip_c) +
                        "); change one of them");
}

// Without it a step of the target is at once a following error.
void checkFollowingError(MotorParse& in) {
  const auto given = in.settings.find("following_error_deg");
  if (!given || in.settings.mentions("angle_slew_deg_per_s")) return;
  in.problems.error(
      given->place(), given->path,
      "needs angle_slew_deg_per_s: without it every step of the target would be a fault; add it");
}

Duration currentPeriod(const MotorParse& in) { return currentPeriodOf(in.motor(), in.traits); }

void checkStall(MotorParse& in) {
  const auto given = in.settings.find("stall_ms");
  const auto stall_ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(in.draft.config.guard.stall_time);
  if (!given || stall_ms.count() == 0) return;
  const std::string_view key = in.traits.own_limit_key;
  if (!key.empty() && !in.settings.mentions(key)) {
    in.problems.error(given->place(), given->path,
                      "needs " + std::string{key} +
                          ": a stall is a current at the limit that the drive itself has; write what is set "
                          "there");
    return;
  }
  const Duration period = currentPeriod(in);
  const auto least = std::chrono::ceil<std::chrono::milliseconds>(kReports * period);
  if (stall_ms >= least) return;
  in.problems.error(given->place(), given->path,
                    given->text() + " ms is shorter than two reports of the current, which comes every " +
                        numberText(std::chrono::duration<double, std::milli>(period).count()) +
                        " ms; write " + std::to_string(least.count()) +
                        " or more, or let it come more often");
}

void checkRunaway(MotorParse& in, const GivenValue& given) {
  const auto refuse = [&](const std::string& text) { in.problems.error(given.place(), given.path, text); };
  if (in.traits.yields)
    return refuse("its control bounds a force and yields to a larger one, which is no runaway; remove it");
  const bool seen = in.traits.unseen_limit_remedy.empty();
  if (!seen && !in.traits.modes.contains(ControlMode::kCurrent)) {
    return refuse("nothing tells that its loop is at the limit of its current: " +
                  std::string{in.traits.unseen_limit_remedy} +
                  ", or write an overspeed_rpm below its no-load speed instead");
  }
  const bool known = in.traits.own_limit_key.empty() || in.motor().own_limit_a > 0.0F;
  const bool in_loops = seen && known;
  if (in_loops) return;
  in.problems.warning(given.place(), given.path,
                      "acts on current targets alone: that a loop of the drive is at its limit is not known" +
                          (seen ? "; write " + std::string{in.traits.own_limit_key} : std::string{}));
}

void readRunaway(MotorParse& in) {
  GuardConfig& guard = in.draft.config.guard;
  const bool guessed = !(in.traits.no_load_rpm > 0.0F) && in.noLoadRpm() > 0.0;
  guard.runaway_rpm =
      static_cast<float>(std::max(kRunaway * in.noLoadRpm(), guessed ? kLeastUnknownRunawayRpm : 0.0));
  if (in.traits.limit_by_report)
    guard.runaway_time = std::max(kReportedRunawayTime, kReports * currentPeriod(in));
  guard.velocity_limit_rpm = in.motor().velocity_limit_rpm;
  if (in.traits.yields) guard.runaway_rpm = 0.0F;
  in.settings.read("runaway_rpm", guard.runaway_rpm);
  if (const auto given = in.settings.find("runaway_rpm")) checkRunaway(in, *given);
}

void readRest(MotorParse& in) {
  RestConfig& rest = in.draft.config.rest;
  rest.gained_rpm = static_cast<float>(kRunaway * in.noLoadRpm());
  rest.current_a = kRest * in.traits.signed_a;
  const float limit_a = in.byVoltage() ? 0.0F : in.motor().effort_limit;
  if (limit_a > 0.0F) rest.current_a = std::min(rest.current_a, kRestOfLimit * limit_a);
  in.settings.read("rest_current_a", rest.current_a);
  rest.time = kRestTime;
  if (const auto period = currentPeriod(in); period > kFastCurrent) rest.time += kReports * period;
  if (const auto given_ms = in.settings.number("rest_ms"))
    rest.time = std::chrono::milliseconds{static_cast<int>(*given_ms)};
}

}  // namespace

void readGuard(MotorParse& in) {
  GuardConfig& guard = in.draft.config.guard;
  in.motor().own_limit_a = in.traits.own_peak_a;
  in.settings.read(in.traits.own_limit_key, in.motor().own_limit_a);
  guard.overspeed_rpm = defaultOverspeedRpm(in);
  guard.stall_rpm = static_cast<float>(kStall * in.noLoadRpm());
  in.settings.read("overspeed_rpm", guard.overspeed_rpm);
  if (in.traits.reports_temperature) {
    guard.temperature_derate_c = kDerateC;
    guard.temperature_trip_c = kTripC;
  }
  in.settings.read("temperature_derate_c", guard.temperature_derate_c);
  in.settings.read("temperature_trip_c", guard.temperature_trip_c);
  const auto stall_ms = in.settings.number("stall_ms").value_or(0.0);
  guard.stall_time = std::chrono::milliseconds{static_cast<int>(stall_ms)};
  guard.stall_trips = in.settings.text("stall_action") != "notify";
  if (guard.stall_rpm > 0.0F) {
    in.draft.config.standstill_rpm = guard.stall_rpm;
  } else {  // neither its no-load speed is known, nor a limit
    guard.stall_rpm = in.draft.config.standstill_rpm;
  }
  guard.encoder_jumps = true;
  readRunaway(in);
  guard.frozen_a = kFrozen * in.traits.frozen_a;
  in.settings.read("following_error_deg", guard.following_error_deg);
  const auto behind_ms = in.settings.number("following_error_ms").value_or(kFollowingErrorMs);
  guard.following_error_time = std::chrono::milliseconds{static_cast<int>(behind_ms)};
  readRest(in);
  if (const auto percent = in.settings.number("scale_error_percent"))
    in.motor().scale_error = *percent / 100.0;
  checkOverspeed(in);
  checkTemperatures(in);
  checkFollowingError(in);
  checkStall(in);
}

}  // namespace rc10
