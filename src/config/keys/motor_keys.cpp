#include "config/keys/motor_keys.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "config/keys/key_table.hpp"
#include "config/motor_families.hpp"
#include "motor/guarding/fallback.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

std::vector<std::string_view> modelNames() {
  std::vector<std::string_view> names;
  for (const auto& entry : motorFamilies()) {
    const auto models = entry.family->models();
    names.insert(names.end(), models.begin(), models.end());
  }
  return names;
}

std::vector<std::string_view> directions() { return {"1", "-1"}; }
std::vector<std::string_view> stallActions() { return {"fault", "notify"}; }
std::vector<std::string_view> zeroChoices() { return {"none", "power_on"}; }
std::vector<std::string_view> fallbacks() { return {kFallbackWords.begin(), kFallbackWords.end()}; }

constexpr Range kSlew{.min = 0, .max = 1'000'000, .above_min = true};
constexpr Range kSoftLimit{.min = -1'000'000, .max = 1'000'000};

/// The first three belong to one motor; the rest may also stand in a profile.
constexpr std::size_t kKeysOfOneMotor = 3;

constexpr std::array kMotorKeys{
    Key{.name = "name",
        .kind = kText,
        .form = &kNameForm,
        .required = true,
        .about = "Name of the motor in commands and states, unique in the robot."},
    Key{.name = "id",
        .kind = kInteger,
        .range = {.min = 0, .max = kByModel},
        .required = true,
        .about = "Id set on the drive. On one bus GM6020 ids 1-4 collide with M3508 and M2006 ids 5-8."},
    Key{.name = "profile",
        .kind = kText,
        .form = &kNameForm,
        .about = "Name of the profile whose keys hold where this motor has none of its own."},
    Key{.name = "model",
        .kind = kText,
        .choices = modelNames,
        .about = "What it is: see docs/motors.md. Required here or in the profile. Keys that only its family "
                 "has stand on the page of the family."},
    Key{.name = "direction",
        .kind = kInteger,
        .choices = directions,
        .default_text = "1",
        .about = "-1: mounted the other way round, so that the robot's positive is the motor's negative."},
    Key{.name = "gear_ratio",
        .kind = kNumber,
        .range = {.min = 0, .max = 10'000, .above_min = true},
        .about =
            "Rotor turns per turn of the output shaft. Default: of the model. Default gains, speed limits "
            "and thresholds follow it; those in the file hold as they are written."},
    Key{.name = "current_limit_a",
        .kind = kNumber,
        .unit = "A",
        .range = {.min = 0, .max = kByModel, .above_min = true},
        .needs = kNeedsCurrent,
        .twin = "voltage_limit_v",
        .about =
            "Largest current commanded. Loops of the drive obey its own maximum instead: velocity and "
            "angle of MyActuator, VESC and CubeMars servo (duty of the last two, too), angle of LK-Tech. "
            "For MyActuator and LK-Tech `stall_ms` and `runaway_rpm` take this key for it: write no more "
            "than that. Default: the most there is, full scale of the drive."},
    Key{.name = "voltage_limit_v",
        .kind = kNumber,
        .unit = "V",
        .range = {.min = 0, .max = kByModel, .above_min = true},
        .needs = kNeedsVoltage,
        .twin = "current_limit_a",
        .about = "Largest voltage commanded. Default: the most there is, full scale of the drive."},
    Key{.name = "velocity_limit_rpm",
        .kind = kNumber,
        .unit = "rpm",
        .range = {.min = 0, .max = 100'000, .above_min = true},
        .about = "Bounds every velocity target and the angle loop. Default: of the model, about its no-load "
                 "speed."},
    Key{.name = "overspeed_rpm",
        .kind = kNumber,
        .unit = "rpm",
        .range = {.min = 0, .max = 100'000, .above_min = true},
        .about =
            "Three samples faster than this are a fault. Must be above velocity_limit_rpm, and within what "
            "the drive reports. Default: 1.5 times the model's no-load speed (of "
            "`velocity_limit_rpm` where that is not known), at most 98 % of the fastest that it reports; "
            "none where that is about the no-load speed (RobStride)."},
    Key{.name = "reduced_velocity_rpm",
        .kind = kNumber,
        .unit = "rpm",
        .range = {.min = 0, .max = 100'000, .above_min = true},
        .about = "Bounds the speed in every mode while the contact of mode_gpio is open. Must be below "
                 "velocity_limit_rpm. A shaft a quarter faster, and 2 % of the no-load speed, is a fault "
                 "after reduced_within_ms; must be low enough for the drive to report that fault. Default: "
                 "the speed is not reduced."},
    Key{.name = "reduced_within_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 20, .max = 60'000},
        .default_text = "1000",
        .about = "Time to come down to reduced_velocity_rpm: along velocity_slew_rpm_per_s; without one, or "
                 "where a load turns the shaft faster than velocity_limit_rpm, within half of it."},
    Key{.name = "reduced_current_a",
        .kind = kNumber,
        .unit = "A",
        .range = {.min = 0, .max = kByModel, .above_min = true},
        .needs = kNeedsCurrent | kNeedsToldLimit,
        .twin = "reduced_voltage_v",
        .about =
            "In place of current_limit_a while the contact of mode_gpio is open, once the shaft has come "
            "down. Not for Damiao control velocity and position_velocity. Default: not reduced."},
    Key{.name = "reduced_voltage_v",
        .kind = kNumber,
        .unit = "V",
        .range = {.min = 0, .max = kByModel, .above_min = true},
        .needs = kNeedsVoltage | kNeedsToldLimit,
        .twin = "reduced_current_a",
        .about =
            "In place of voltage_limit_v while the contact of mode_gpio is open, once the shaft has come "
            "down. Default: not reduced."},
    Key{.name = "temperature_derate_c",
        .kind = kNumber,
        .unit = "C",
        .range = {.min = 0, .max = 150, .above_min = true},
        .needs = kNeedsTemperature,
        .default_text = "80",
        .about = "From here on the current or voltage limit comes down, to 0 at temperature_trip_c; it comes "
                 "back 3 C cooler, by a fifth a second. Not for drives that report no temperature, as the "
                 "M2006."},
    Key{.name = "temperature_trip_c",
        .kind = kNumber,
        .unit = "C",
        .range = {.min = 0, .max = 150, .above_min = true},
        .needs = kNeedsTemperature,
        .default_text = "100",
        .about = "This temperature is a fault. Not for drives that report no temperature, as the M2006."},
    Key{.name = "stall_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 0, .max = 60'000},
        .needs = kNeedsSeenLimit,
        .default_text = "0",
        .about = "This time at the current or voltage limit without turning (2 % of the no-load speed, or of "
                 "`velocity_limit_rpm` where that is not known; without either 10 rpm) is a stall. 0: not "
                 "watched. Not where that limit is not seen: Damiao control velocity and position_velocity, "
                 "CubeMars servo, ODrive without telemetry_hz. A VESC needs motor_current_max_a, LK-Tech and "
                 "MyActuator current_limit_a. At least two reports of the current."},
    Key{.name = "stall_action",
        .kind = kText,
        .choices = stallActions,
        .needs = kNeedsSeenLimit,
        .default_text = "fault",
        .about = "fault: the motor stops until cleared. notify: the state shows it, nothing else."},
    Key{.name = "runaway_rpm",
        .kind = kNumber,
        .unit = "rpm",
        .range = {.min = 0, .max = 100'000, .above_min = true},
        .about =
            "A motor at its current or voltage limit that gains so much speed the other way is a fault: "
            "at once, or where a loop of the drive is at its limit once it has kept that for 100 ms and "
            "two reports of the current. A load that is let down as asked is none. Default: a tenth of "
            "the no-load speed; of velocity_limit_rpm where that is not known, at least 60; none where "
            "neither is known. Not for Damiao control velocity and position_velocity, where the limit is "
            "not seen, nor force_position, which yields."},
    Key{.name = "rest_current_a",
        .kind = kNumber,
        .unit = "A",
        .range = {.min = 0, .max = 1000},
        .needs = kNeedsSignedCurrent,
        .about =
            "A drive that is told to rest and reports more than this, along with its motion or at "
            "standstill, "
            "for rest_ms is a fault. 0: not watched. Default: 5 % of the current that it can report, at most "
            "half of current_limit_a."},
    Key{.name = "rest_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 20, .max = 10'000},
        .needs = kNeedsSignedCurrent,
        .about = "See rest_current_a; three samples at least. Default: 100, and of a drive that reports its "
                 "current less often than 50 times a second two of its reports more."},
    Key{.name = "scale_error_percent",
        .kind = kNumber,
        .unit = "%",
        .range = {.min = 0, .max = 100},
        .needs = kNeedsScaledSpeed,
        .default_text = "20",
        .about = "A speed reported in the first motion that is further from the change of the angle is a "
                 "fault: the scale is another model's. Not below the error of the drive's speed, some %. For "
                 "drives that report shares of a range: Damiao, RobStride, MyActuator, CubeMars MIT. 0: not "
                 "compared."},
    Key{.name = "on_timeout",
        .kind = kText,
        .choices = fallbacks,
        .default_text = "coast",
        .about =
            "What the motor does when its last command has lapsed. coast: no torque. damp: resists in "
            "proportion to its speed. brake: stops and resists. hold: stays at its angle. ramp: comes to "
            "rest within ramp_s, and then has no torque. See docs/safety.md#fallbacks."},
    Key{.name = "on_disable",
        .kind = kText,
        .choices = fallbacks,
        .default_text = "coast",
        .about = "The same after a disable request and when rc10d ends, until it stands still."},
    Key{.name = "on_estop",
        .kind = kText,
        .choices = fallbacks,
        .default_text = "coast",
        .about = "The same during an emergency stop, and when its group stops."},
    Key{.name = "hold_max_s",
        .kind = kNumber,
        .unit = "s",
        .range = {.min = 0, .max = 3600, .above_min = true},
        .default_text = "10",
        .about = "A fallback hold becomes damp after this time; brake, where the drive cannot damp."},
    Key{.name = "brake_max_s",
        .kind = kNumber,
        .unit = "s",
        .range = {.min = 0, .max = 3600, .above_min = true},
        .default_text = "10",
        .about =
            "A brake in an e-stop becomes damp after this time, if the drive can. When its group stops it "
            "stays: the robot may stand on a slope."},
    Key{.name = "ramp_s",
        .kind = kNumber,
        .unit = "s",
        .range = {.min = 0.02, .max = 60},
        .default_text = "1",
        .about = "A fallback ramp takes the speed to 0 in this time, whatever it was, and 0.2 s later the "
                 "torque. What gravity pulls on falls then."},
    Key{.name = "run_down_s",
        .kind = kNumber,
        .unit = "s",
        .range = {.min = 0, .max = 3600},
        .default_text = "5",
        .about =
            "Without torque the motor turns no longer than this: an e-stop is not cleared before a motor "
            "that was lost while it was enabled, or turned, has been unheard for so long. A flywheel "
            "needs more."},
    Key{.name = "current_slew_a_per_s",
        .kind = kNumber,
        .unit = "A/s",
        .range = kSlew,
        .needs = kNeedsCurrent,
        .twin = "voltage_slew_v_per_s",
        .about = "How fast a current target may change. Default: at once."},
    Key{.name = "voltage_slew_v_per_s",
        .kind = kNumber,
        .unit = "V/s",
        .range = kSlew,
        .needs = kNeedsVoltage,
        .twin = "current_slew_a_per_s",
        .about = "How fast a voltage target may change. Default: at once."},
    Key{.name = "velocity_slew_rpm_per_s",
        .kind = kNumber,
        .unit = "rpm/s",
        .range = kSlew,
        .about = "How fast a velocity target may change. Default: at once."},
    Key{.name = "angle_slew_deg_per_s",
        .kind = kNumber,
        .unit = "deg/s",
        .range = kSlew,
        .needs = kNeedsAngle,
        .about = "How fast an angle target may move; the angle loop's velocity limit holds anyway. Not "
                 "for a VESC with angle: none. Default: at once."},
    Key{.name = "angle_min_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = kSoftLimit,
        .needs = kNeedsAngle,
        .about =
            "Soft limit of the multi-turn angle, in force while the angle is referenced. No target "
            "leads beyond it; moving back is allowed. With both limits set they tell an absolute encoder "
            "its turn at power-up. See docs/safety.md#soft-limits. Not for a VESC with angle: none. "
            "Default: none."},
    Key{.name = "angle_max_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = kSoftLimit,
        .needs = kNeedsAngle,
        .about = "The other soft limit. Not for a VESC with angle: none. Default: none."},
    Key{.name = "max_first_step_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = 0, .max = 1'000'000, .above_min = true},
        .needs = kNeedsAngle,
        .about = "An angle target that follows none is refused if it is farther than this from the measured "
                 "angle. Not for a VESC with angle: none. Default: 180 for an absolute encoder with a soft "
                 "limit and without angle_slew_deg_per_s, else any distance."},
    Key{.name = "soft_start_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 0, .max = 10'000},
        .default_text = "200",
        .about =
            "After enabling the first targets come into force over this time, from what is measured then: "
            "a client may have been sending. 0: at once."},
    Key{.name = "following_error_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = 0, .max = 1'000'000, .above_min = true},
        .needs = kNeedsAngle,
        .about = "This distance from the angle target, for following_error_ms, is a fault. Needs "
                 "angle_slew_deg_per_s. Not for a VESC with angle: none. Default: not watched."},
    Key{.name = "following_error_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 1, .max = 60'000},
        .default_text = "200",
        .about = "See following_error_deg."},
    Key{.name = "zero",
        .kind = kText,
        .choices = zeroChoices,
        .default_text = "none",
        .about = "power_on: the angle at the first feedback is 0. none: a geared motor refuses angle targets "
                 "until it "
                 "is zeroed by request."},
    Key{.name = "zero_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = -360, .max = 360},
        .needs = kNeedsAbsolute,
        .twin = "zero: power_on",
        .default_text = "0",
        .about = "Angle of an absolute encoder that is to read 0 (GM6020)."},
    Key{.name = "feedback_hz",
        .kind = kInteger,
        .unit = "Hz",
        .range = {.min = 1, .max = kByModel},
        .needs = kNeedsUnasked,
        .twin = "command_divider",
        .about =
            "Feedback rate set on the drive (C620 and GM6020: RoboMaster Assistant; VESC: VESC Tool), for "
            "the predicted load and for what counts as stale. Default: the model's own, DJI 1000. "
            "At least 200 for DJI, 50 for a VESC with angle: tachometer."},
    Key{.name = "command_divider",
        .kind = kInteger,
        .range = {.min = 1, .max = 100},
        .needs = kNeedsOwnFrames,
        .about = "The drive gets a command in every n-th tick; the motors of a bus take turns. A drive "
                 "that only answers sends its feedback at that rate: with one answer lost its silence must "
                 "not look like a restart, so at 1 kHz at most 49 for LK-Tech and MyActuator, 99 for "
                 "RobStride, less for a fast Damiao. Not for motors that share frames (DJI). Default: 1."},
    Key{.name = "feedback_timeout_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 2, .max = 1000},
        .about =
            "Without feedback for this long the motor is offline and gets no torque. A DJI, LK-Tech or VESC "
            "drive that is heard again after 300 ms or more may have been restarted: its motor is ACTIVE no "
            "more, whatever is written. Default: 20, but at least four periods of its feedback."},
    Key{.name = "optional",
        .kind = kBoolean,
        .default_text = "false",
        .about = "true: the robot may be enabled although this motor does not answer. An enable request that "
                 "fails for some optional motors only is answered as done, and names them."},
    Key{.name = "velocity_pid",
        .kind = kSection,
        .section = &kVelocityPidSection,
        .needs = kNeedsHostLoops | kNeedsHostVelocity,
        .about = "Velocity loop: rpm to A, or to V. Keys not given keep the model's defaults, per rpm behind "
                 "gear_ratio. Not for a VESC, which closes it itself."},
    Key{.name = "angle_pid",
        .kind = kSection,
        .section = &kAnglePidSection,
        .needs = kNeedsHostLoops,
        .about = "Angle loop: degrees to rpm. Keys not given keep the model's defaults."},
    Key{.name = "simulated",
        .kind = kSection,
        .section = &kSimulatedSection,
        .about = "What hangs on the shaft when the motor is simulated (a bus of type sim, or rc10-sim), and "
                 "what is wrong with it."}};

[[nodiscard]] ValueKind valueKindOf(OwnKey::Kind kind) {
  switch (kind) {
    case OwnKey::Kind::kNumber: return kNumber;
    case OwnKey::Kind::kInteger: return kInteger;
    case OwnKey::Kind::kFlag: return kBoolean;
    default: break;  // the others are those of modules
  }
  return kText;
}

/// A key that one or more families have: what the loader accepts of it before it knows the model.
struct JoinedKey {
  OwnKey key;
  std::vector<std::string_view> choices;
  std::string about;

  JoinedKey(const OwnKey& first, std::string_view family)
      : key(first), choices(first.choices.begin(), first.choices.end()), about(aboutOf(first, family)) {}

  void join(const OwnKey& other, std::string_view family) {
    key.min = std::min(key.min, other.min);
    key.max = std::max(key.max, other.max);
    key.above_min = key.above_min && other.above_min;
    if (key.default_text != other.default_text) key.default_text = {};
    for (const auto word : other.choices) {
      if (std::find(choices.begin(), choices.end(), word) == choices.end()) choices.push_back(word);
    }
    about += " " + aboutOf(other, family);
  }

  [[nodiscard]] Key made() const {
    // Whether it is required, the family asks: another family's motor need not have it.
    Key made = motorKeyOf(key);
    made.words = choices;
    made.about = about;
    return made;
  }

 private:
  [[nodiscard]] static std::string aboutOf(const OwnKey& key, std::string_view family) {
    std::string text = std::string{family} + ": " + std::string{key.about};
    if (!text.ends_with('.')) text += '.';
    return text;
  }
};

/// The keys that all motors have, then those of the families, each name once.
class MotorKeys {
 public:
  MotorKeys() : keys_(kMotorKeys.begin(), kMotorKeys.end()) {
    for (const auto& entry : motorFamilies()) {
      for (const OwnKey& key : entry.family->keys()) add(key, entry.family->name());
    }
    for (const JoinedKey& own : own_) keys_.push_back(own.made());
  }
  [[nodiscard]] std::span<const Key> all() const noexcept { return keys_; }

 private:
  void add(const OwnKey& key, std::string_view family) {
    const auto found = std::find_if(own_.begin(), own_.end(),
                                    [&](const JoinedKey& own) { return own.key.name == key.name; });
    if (found != own_.end()) {
      found->join(key, family);
    } else {
      own_.emplace_back(key, family);
    }
  }

  std::vector<JoinedKey> own_;
  std::vector<Key> keys_;
};

bool motor_keys_made = false;

[[nodiscard]] std::span<const Key> motorKeys() {
  static const MotorKeys kKeys;
  motor_keys_made = true;
  return kKeys.all();
}

[[nodiscard]] std::span<const Key> profileKeys() { return motorKeys().subspan(kKeysOfOneMotor); }

}  // namespace

Key motorKeyOf(const OwnKey& key) {
  return {.name = key.name,
          .kind = valueKindOf(key.kind),
          .unit = key.unit,
          .range = {.min = key.min, .max = key.max, .above_min = key.above_min},
          .words = key.choices,
          .default_text = key.default_text,
          .about = key.about};
}

bool isCommonMotorKey(std::string_view name) {
  return std::any_of(kMotorKeys.begin(), kMotorKeys.end(),
                     [name](const Key& key) { return key.name == name; });
}

bool motorKeysMade() noexcept { return motor_keys_made; }

constexpr Section kMotorSection{
    "motor", {}, "One motor. All angles, speeds and torques are at its output shaft.", motorKeys};
constexpr Section kProfileSection{"profile", {}, "Keys that several motors share.", profileKeys};

}  // namespace rc10
