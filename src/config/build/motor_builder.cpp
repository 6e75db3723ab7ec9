#include "config/build/motor_builder.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>

#include "config/build/loop_builder.hpp"
#include "config/keys/need_check.hpp"
#include "config/keys/value_check.hpp"
#include "config/motor_families.hpp"
#include "config/yaml/number_text.hpp"
#include "motor/guarding/fallback.hpp"

namespace rc10 {
namespace {

// Of the no-load speed at 24 V: out of reach for the drive alone; and slower than a turning motor's noise.
constexpr double kOverspeed = 1.5;
constexpr double kStall = 0.02;
// Against all its torque: more than a load or another robot that pushes adds.
constexpr double kRunaway = 0.1;
// Of full scale: what a drive's current may be off by while it is in order.
constexpr float kFrozen = 0.05F;
// GM6020 manual: it warns above 100 C, its winding stands 125 C; the C620 warns from 125 C.
constexpr float kDerateC = 80.0F;
constexpr float kTripC = 100.0F;
constexpr double kFollowingErrorMs = 200.0;
// Drives with loops of their own: a speed that stops within a tenth of a second, and the share of the
// no-load speed over which the effort comes down.
constexpr float kNativeApproach = 2.0F;
constexpr float kFullEffort = 0.2F;
constexpr Duration kFreshEnough = std::chrono::milliseconds{20};
constexpr int kPeriodsToStale = 4;

/// One motor's settings on their way into its MotorConfig, with the checks that need the model.
class MotorBuilder {
 public:
  MotorBuilder(const Settings& settings, MotorDraft& draft, Problems& problems)
      : settings_(settings), motor_(draft.config.settings), draft_(draft), problems_(problems) {}

  void build(int tick_hz) {
    motor_.tick_hz = tick_hz;
    readPlain();
    readSimulated();
    if (!readModel()) return;
    const bool own_known = readOwnKeys();
    traits_ = draft_.config.traits();
    settings_.read("gear_ratio", motor_.gear_ratio);
    draft_.complete = readId() && own_known && checkOwnKeys();
    if (!draft_.complete) return;
    checkKeys();
    readEffortLimit();
    readZero();
    readLoops();
    readRates();
    checkFeedback();
    checkVelocityLimit();
    readGuard();
    readFallbacks();
    readShaping();
  }

 private:
  void readPlain() {
    settings_.read("name", motor_.name);
    settings_.read("direction", motor_.direction);
    settings_.read("optional", draft_.config.optional);
  }

  void readSimulated() {
    const Settings simulated = settings_.section("simulated");
    sim::MotorLoad& load = draft_.config.simulated;
    simulated.read("inertia_kg_m2", load.inertia_kg_m2);
    simulated.read("viscous_nms_per_rad", load.viscous_nms_per_rad);
    simulated.read("coulomb_nm", load.coulomb_nm);
    simulated.read("load_torque_nm", load.load_torque_nm);
    simulated.read("initial_angle_deg", load.initial_angle_deg);
    simulated.read("stalled", load.stalled);
    simulated.read("silent", load.silent);
    simulated.read("lost_frames", load.lost_frames);
  }

  bool readModel() {
    motor_.model = settings_.text("model");
    const auto* entry = findFamily(motor_.model);
    draft_.config.family = entry != nullptr ? entry->family : nullptr;
    return entry != nullptr;
  }

  bool readId() {
    const auto id = settings_.find("id");
    if (!id) return false;
    draft_.id_place = id->place();
    settings_.read("id", motor_.id);
    if (motor_.id >= traits_.min_id && motor_.id <= traits_.max_id) return true;
    const bool low = motor_.id < traits_.min_id;
    problems_.error(id->place(), id->path,
                    id->text() + (low ? " is below the lowest " : " is above the highest ") + modelName() +
                        " id " + std::to_string(low ? traits_.min_id : traits_.max_id) + "; use " +
                        std::to_string(traits_.min_id) + " to " + std::to_string(traits_.max_id));
    return false;
  }

  /// The keys of this family, with their defaults; and those of others, which mean nothing here.
  bool readOwnKeys() {
    bool complete = true;
    for (const FamilyKey& key : draft_.config.family->keys()) complete &= readOwnKey(key);
    for (const auto& other : motorFamilies()) {
      for (const FamilyKey& key : other.family->keys()) refuseForeignKey(key, *other.family);
    }
    return complete;
  }

  bool readOwnKey(const FamilyKey& key) {
    const auto given = settings_.find(key.name);
    if (!given && settings_.mentions(key.name)) return false;  // refused already
    if (!given && key.required) {
      problems_.error(draft_.config.place, joinPath(draft_.path, key.name),
                      "is missing for the " + modelName() + "; add it: " + std::string{key.about});
      return false;
    }
    const std::string text = given ? given->text() : std::string{key.default_text};
    if (key.kind == FamilyKey::Kind::kChoice) {
      motor_.own.set(key.name, text);
    } else if (key.kind == FamilyKey::Kind::kFlag) {
      motor_.own.set(key.name, text == "true" ? 1.0 : 0.0);
    } else {
      const auto value = parseNumber(text);
      motor_.own.set(key.name, value ? *value : 0.0);
    }
    return !given || ownRange(key, *given);
  }

  /// Families share the names of keys, not always their ranges.
  bool ownRange(const FamilyKey& key, const GivenValue& given) {
    if (key.kind == FamilyKey::Kind::kChoice) {
      if (std::find(key.choices.begin(), key.choices.end(), given.text()) != key.choices.end()) return true;
      const std::vector<std::string> words{key.choices.begin(), key.choices.end()};
      problems_.error(given.place(), given.path,
                      inQuotes(given.text()) + " is nothing that the " + modelName() + " knows; use " +
                          listWords(words, " or "));
      return false;
    }
    if (key.kind == FamilyKey::Kind::kFlag) return true;
    const double value = motor_.own.number(key.name);
    if (value <= key.max && (key.above_min ? value > key.min : value >= key.min)) return true;
    const Range range{.min = key.min, .max = key.max, .above_min = key.above_min};
    problems_.error(
        given.place(), given.path,
        given.text() + " is outside what the " + modelName() + " takes; " + useWords(range, key.unit));
    return false;
  }

  void refuseForeignKey(const FamilyKey& key, const MotorFamily& other) {
    const auto own = draft_.config.family->keys();
    const bool known =
        std::any_of(own.begin(), own.end(), [&](const FamilyKey& mine) { return mine.name == key.name; });
    const auto given = known ? std::nullopt : settings_.find(key.name);
    if (!given || !refused_.insert(key.name).second) return;
    problems_.error(given->place(), given->path,
                    "means nothing for the " + modelName() + "; it belongs to " + std::string{other.name()} +
                        ". Remove it");
  }

  /// Check by the family: its errors begin with the key.
  bool checkOwnKeys() {
    settings_.read(effortKey(), motor_.effort_limit);
    settings_.read("velocity_limit_rpm", motor_.velocity_limit_rpm);
    settings_.read("command_divider", motor_.command_divider);
    const auto good = draft_.config.family->check(motor_);
    if (good) return true;
    const std::string& message = good.error().message;
    const auto colon = message.find(": ");
    const auto key = colon != std::string::npos ? message.substr(0, colon) : std::string{};
    if (const auto given = key.empty() ? std::nullopt : settings_.find(key)) {
      problems_.error(given->place(), given->path, message.substr(colon + 2));
    } else {
      problems_.error(draft_.config.place, draft_.path, message);
    }
    return false;
  }

  [[nodiscard]] bool knowsItsAngle() const noexcept {
    const bool own_gear = motor_.gear_ratio == 0.0 || motor_.gear_ratio == traits_.gear_ratio;
    return traits_.absolute && own_gear;
  }

  void checkKeys() {
    const bool has_loops = traits_.host_loops != nullptr;
    const bool shares = !draft_.config.family->busUse(motor_).layout.empty();
    const MotorNature nature{motor_.model, traits_, knowsItsAngle(),
                             has_loops && wantsIncremental(settings_, *traits_.host_loops), shares};
    checkNeeds(settings_, kMotorSection, nature, problems_);
    if (has_loops) checkNeeds(settings_.section("velocity_pid"), kVelocityPidSection, nature, problems_);
  }

  void readEffortLimit() {
    const char* key = effortKey();
    const float full_scale = traits_.effort_full_scale;
    settings_.read(key, motor_.effort_limit);
    const auto given = settings_.find(key);
    const double limit = settings_.number(key).value_or(0.0);
    if (!given || limit <= static_cast<double>(full_scale)) return;
    const Range range{.min = 0.0, .max = static_cast<double>(full_scale), .above_min = true};
    problems_.error(given->place(), given->path,
                    numberText(limit) + " is above the " + modelName() + " limit of " +
                        numberText(range.max) + "; " + useWords(range, ""));
  }

  void readZero() {
    motor_.zero_at_power_on = settings_.text("zero") == "power_on";
    if (!knowsItsAngle()) return;
    settings_.read("zero_deg", motor_.zero_deg);
    const auto zero_deg = settings_.find("zero_deg");
    if (!zero_deg || !motor_.zero_at_power_on || motor_.zero_deg == 0.0) return;
    problems_.error(zero_deg->place(), zero_deg->path, "excludes zero: power_on; keep one of them");
  }

  void readLoops() {
    settings_.read("velocity_limit_rpm", motor_.velocity_limit_rpm);
    if (traits_.host_loops == nullptr) return;
    motor_.loops = buildLoops(settings_, *traits_.host_loops, byVoltage());
    motor_.velocity_limit_rpm = motor_.loops.velocity_limit_rpm;
  }

  void readRates() {
    settings_.read("command_divider", motor_.command_divider);
    motor_.feedback_hz =
        traits_.asked ? std::max(1, motor_.tick_hz / motor_.command_divider) : traits_.feedback_hz;
    settings_.read("feedback_hz", motor_.feedback_hz);
    const auto period = std::chrono::duration_cast<Duration>(std::chrono::seconds{1}) / motor_.feedback_hz;
    draft_.config.feedback_timeout = std::max<Duration>(kFreshEnough, kPeriodsToStale * period);
    if (const auto timeout = settings_.number("feedback_timeout_ms")) {
      draft_.config.feedback_timeout = std::chrono::milliseconds{static_cast<int>(*timeout)};
    }
    const auto given = settings_.find("feedback_hz");
    if (!given ||
        (motor_.feedback_hz >= traits_.min_feedback_hz && motor_.feedback_hz <= traits_.max_feedback_hz))
      return;
    const bool low = motor_.feedback_hz < traits_.min_feedback_hz;
    problems_.error(given->place(), given->path,
                    given->text() + (low ? " is below " : " is above ") +
                        std::to_string(low ? traits_.min_feedback_hz : traits_.max_feedback_hz) +
                        " Hz; use " + std::to_string(traits_.min_feedback_hz) + " to " +
                        std::to_string(traits_.max_feedback_hz) + " Hz");
  }

  void checkFeedback() {
    const auto period = std::chrono::duration_cast<Duration>(std::chrono::seconds{1}) / motor_.feedback_hz;
    const auto given = settings_.find("feedback_timeout_ms");
    if (!given || draft_.config.feedback_timeout >= 2 * period) return;
    const int rate_hz = motor_.feedback_hz;
    problems_.error(given->place(), given->path,
                    given->text() + " ms is less than two periods of feedback at " + std::to_string(rate_hz) +
                        " Hz; use at least " + std::to_string((2000 + rate_hz - 1) / rate_hz) + " ms");
  }

  [[nodiscard]] const char* effortKey() const noexcept {
    return byVoltage() ? "voltage_limit_v" : "current_limit_a";
  }

  [[nodiscard]] bool byVoltage() const noexcept { return traits_.effort == CommandUnit::kVolt; }

  [[nodiscard]] double gear() const noexcept {
    return motor_.gear_ratio > 0.0 ? motor_.gear_ratio : traits_.gear_ratio;
  }

  /// Of a model whose speed nobody knows: what the user allows, or 0.
  [[nodiscard]] double noLoadRpm() const noexcept {
    if (traits_.no_load_rpm <= 0.0F) return static_cast<double>(motor_.velocity_limit_rpm);
    return static_cast<double>(traits_.no_load_rpm) * traits_.gear_ratio / gear();
  }

  [[nodiscard]] double torqueNmPerA() const noexcept {
    return static_cast<double>(traits_.torque_nm_per_a) / traits_.gear_ratio * gear();
  }

  void readGuard() {
    GuardConfig& guard = draft_.config.guard;
    guard.overspeed_rpm = static_cast<float>(kOverspeed * noLoadRpm());
    guard.stall_rpm = static_cast<float>(kStall * noLoadRpm());
    settings_.read("overspeed_rpm", guard.overspeed_rpm);
    if (traits_.reports_temperature) {
      guard.temperature_derate_c = kDerateC;
      guard.temperature_trip_c = kTripC;
    }
    settings_.read("temperature_derate_c", guard.temperature_derate_c);
    settings_.read("temperature_trip_c", guard.temperature_trip_c);
    const auto stall_ms = settings_.number("stall_ms").value_or(0.0);
    guard.stall_time = std::chrono::milliseconds{static_cast<int>(stall_ms)};
    guard.stall_trips = settings_.text("stall_action") != "notify";
    if (guard.stall_rpm > 0.0F) draft_.config.standstill_rpm = guard.stall_rpm;
    guard.encoder_jumps = true;
    guard.runaway_rpm = static_cast<float>(kRunaway * noLoadRpm());
    guard.frozen_a = kFrozen * traits_.frozen_a;
    settings_.read("following_error_deg", guard.following_error_deg);
    const auto behind_ms = settings_.number("following_error_ms").value_or(kFollowingErrorMs);
    guard.following_error_time = std::chrono::milliseconds{static_cast<int>(behind_ms)};
    checkOverspeed();
    checkTemperatures();
    checkFollowingError();
  }

  void readFallbacks() {
    FallbackConfig& fallback = draft_.config.fallback;
    fallback.on_timeout = fallbackOf("on_timeout");
    fallback.on_disable = fallbackOf("on_disable");
    fallback.on_estop = fallbackOf("on_estop");
    for (const auto* key : {"on_timeout", "on_disable", "on_estop"}) checkFallback(key);
    if (const auto hold_s = settings_.number("hold_max_s")) {
      fallback.hold_max = std::chrono::milliseconds{static_cast<std::int64_t>(*hold_s * 1000.0)};
    }
  }

  [[nodiscard]] FallbackAction fallbackOf(std::string_view key) const {
    const auto word = std::find(kFallbackWords.begin(), kFallbackWords.end(), settings_.text(key));
    if (word == kFallbackWords.end()) return FallbackAction::kCoast;
    return static_cast<FallbackAction>(word - kFallbackWords.begin());
  }

  void checkFallback(std::string_view key) {
    const auto given = settings_.find(key);
    if (!given || traits_.frames.of(frameKindOf(fallbackOf(key))) != Provision::kUnsupported) return;
    std::vector<std::string> possible;
    for (std::size_t i = 0; i < kFallbackWords.size(); ++i) {
      const auto kind = frameKindOf(static_cast<FallbackAction>(i));
      if (traits_.frames.of(kind) != Provision::kUnsupported) possible.emplace_back(kFallbackWords[i]);
    }
    problems_.error(
        given->place(), given->path,
        "the " + modelName() + " cannot " + given->text() + " by itself; use " + listWords(possible, " or "));
  }

  void readShaping() {
    ShapingConfig& shaping = draft_.config.shaping;
    settings_.read(byVoltage() ? "voltage_slew_v_per_s" : "current_slew_a_per_s", shaping.effort_slew_per_s);
    settings_.read("velocity_slew_rpm_per_s", shaping.velocity_slew_rpm_per_s);
    settings_.read("angle_slew_deg_per_s", shaping.angle_slew_deg_per_s);
    settings_.read("angle_min_deg", shaping.angle_min_deg);
    settings_.read("angle_max_deg", shaping.angle_max_deg);
    settings_.read("max_first_step_deg", shaping.max_first_step_deg);
    if (traits_.host_loops != nullptr) {
      shaping.approach_rpm_per_deg = kApproachOfAngleGain * motor_.loops.angle.kp;
      shaping.approach_effort_per_rpm =
          std::visit([](const auto& pid) { return pid.kp; }, traits_.host_loops->velocity);
    } else {
      shaping.approach_rpm_per_deg = kNativeApproach;
      if (noLoadRpm() > 0.0)
        shaping.approach_effort_per_rpm =
            traits_.effort_full_scale / (kFullEffort * static_cast<float>(noLoadRpm()));
    }
    if (!byVoltage() && torqueNmPerA() > 0.0)
      shaping.effort_per_nm = static_cast<float>(1.0 / torqueNmPerA());
    if (byVoltage() && noLoadRpm() > 0.0)
      shaping.effort_per_rpm = traits_.effort_full_scale / static_cast<float>(noLoadRpm());
    const auto max_deg = settings_.find("angle_max_deg");
    const auto min_deg = settings_.find("angle_min_deg");
    if (max_deg && min_deg && shaping.angle_min_deg >= shaping.angle_max_deg) {
      problems_.error(
          max_deg->place(), max_deg->path,
          max_deg->text() + " deg is not above angle_min_deg (" + min_deg->text() + "); change one of them");
    }
  }

  // Without it a step of the target is at once a following error.
  void checkFollowingError() {
    const auto given = settings_.find("following_error_deg");
    if (!given || settings_.mentions("angle_slew_deg_per_s")) return;
    problems_.error(
        given->place(), given->path,
        "needs angle_slew_deg_per_s: without it every step of the target would be a fault; add it");
  }

  // A limit that trips on what is asked for would be of no use.
  void checkOverspeed() {
    const auto given = settings_.find("overspeed_rpm");
    const double target_rpm = static_cast<double>(motor_.velocity_limit_rpm);
    if (!given || static_cast<double>(draft_.config.guard.overspeed_rpm) > target_rpm) return;
    problems_.error(given->place(), given->path,
                    given->text() + " rpm is not above the velocity limit of " + numberText(target_rpm) +
                        " rpm; raise it, or lower velocity_limit_rpm");
  }

  void checkTemperatures() {
    const GuardConfig& guard = draft_.config.guard;
    const auto derate = settings_.find("temperature_derate_c");
    const auto trip = settings_.find("temperature_trip_c");
    const auto& given = trip ? trip : derate;
    if (!given || guard.temperature_derate_c < guard.temperature_trip_c) return;
    problems_.error(given->place(), given->path,
                    "temperature_derate_c (" + numberText(static_cast<double>(guard.temperature_derate_c)) +
                        ") must be below temperature_trip_c (" +
                        numberText(static_cast<double>(guard.temperature_trip_c)) + "); change one of them");
  }

  void checkVelocityLimit() {
    const auto given = settings_.find("velocity_limit_rpm");
    const double no_load_rpm = noLoadRpm();
    const bool known = traits_.no_load_rpm > 0.0F;
    if (!given || !known || settings_.number("velocity_limit_rpm").value_or(0.0) <= no_load_rpm) return;
    problems_.warning(given->place(), given->path,
                      given->text() + " rpm is more than the " + modelName() + " reaches without load at " +
                          numberText(traits_.nominal_v) + " V (" + numberText(std::round(no_load_rpm)) +
                          " rpm)");
  }

  [[nodiscard]] std::string modelName() const { return motor_.model; }

  const Settings& settings_;
  MotorSettings& motor_;
  MotorTraits traits_;
  std::set<std::string_view> refused_;
  MotorDraft& draft_;
  Problems& problems_;
};

}  // namespace

MotorDraft buildMotor(const Settings& settings, const SourcePlace& place, const std::string& path,
                      int tick_hz, Problems& problems) {
  MotorDraft draft;
  draft.config.place = place;
  draft.path = path;
  MotorBuilder{settings, draft, problems}.build(tick_hz);
  return draft;
}

}  // namespace rc10
