#include <array>
#include <cstddef>

#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

/// Figures that may change while the motor runs.
constexpr std::array kFigures{
    Key{.name = "inertia_kg_m2",
        .kind = kNumber,
        .unit = "kg m2",
        .range = {.min = 0, .max = 100},
        .about = "Of the load, at the output shaft; the rotor's comes on top. Default: of the model."},
    Key{.name = "viscous_nms_per_rad",
        .kind = kNumber,
        .unit = "N m s/rad",
        .range = {.min = 0, .max = 100},
        .about = "Friction that grows with speed. Default: of the model."},
    Key{.name = "coulomb_nm",
        .kind = kNumber,
        .unit = "N m",
        .range = {.min = 0, .max = 100},
        .about = "Friction that does not. Default: of the model."},
    Key{.name = "load_torque_nm",
        .kind = kNumber,
        .unit = "N m",
        .range = {.min = -1000, .max = 1000},
        .default_text = "0",
        .about = "Constant torque against which the motor works: a hanging weight."},
    Key{.name = "gravity_nm",
        .kind = kNumber,
        .unit = "N m",
        .range = {.min = -1000, .max = 1000},
        .default_text = "0",
        .about =
            "Of an arm: the torque that holds it level, a quarter of a turn from hangs_at_deg; elsewhere "
            "times the sine of the angle from there."},
    Key{.name = "payload_kg",
        .kind = kNumber,
        .unit = "kg",
        .range = {.min = 0, .max = 1000},
        .default_text = "0",
        .about = "Weight that the arm carries: adds to gravity_nm and inertia_kg_m2."},
    Key{.name = "payload_at_m",
        .kind = kNumber,
        .unit = "m",
        .range = {.min = 0, .max = 10},
        .default_text = "0",
        .about = "Distance of the payload from the shaft."}};

constexpr Key kAfter{.name = "after_s",
                     .kind = kNumber,
                     .unit = "s",
                     .range = {.min = 0, .max = 100'000},
                     .required = true,
                     .about = "Since the start of the simulation, or since the changes began anew."};

constexpr auto changeKeys() {
  std::array<Key, kFigures.size() + 1> keys{kAfter};
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    keys[i + 1] = kFigures[i];
    keys[i + 1].default_text = {};
    keys[i + 1].about = "As in simulated, from then on. Default: as before.";
  }
  return keys;
}

constexpr auto kChangeKeys = changeKeys();

}  // namespace

constexpr Section kLoadChangeSection{"load_change", kChangeKeys,
                                     "A change of the load on a simulated motor's shaft."};

namespace {

constexpr std::array kOthers{
    Key{.name = "hangs_at_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = -360'000, .max = 360'000},
        .default_text = "0",
        .about = "Where the arm of gravity_nm and payload_kg hangs at rest."},
    Key{.name = "stop_min_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = -360'000, .max = 360'000},
        .about = "End stop, a rigid one: the shaft does not turn below it. Default: none."},
    Key{.name = "stop_max_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = -360'000, .max = 360'000},
        .about = "End stop above, as stop_min_deg. Default: none."},
    Key{.name = "initial_angle_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = -360'000, .max = 360'000},
        .default_text = "0",
        .about = "Where the shaft stands at the start."},
    Key{.name = "stalled",
        .kind = kBoolean,
        .default_text = "false",
        .about = "true: the shaft does not turn."},
    Key{.name = "silent",
        .kind = kBoolean,
        .default_text = "false",
        .about = "true: the drive sends nothing."},
    Key{.name = "lost_frames",
        .kind = kNumber,
        .range = {.min = 0, .max = 1},
        .default_text = "0",
        .about = "Fraction of the feedback frames that are lost."},
    Key{.name = "drive_id",
        .kind = kInteger,
        .range = {.min = 0, .max = 255},
        .about = "Id set on the drive, where it is not the motor's: the motor is OFFLINE, and a scan finds a "
                 "drive that is not in the file. Default: the motor's id."},
    Key{.name = "changes",
        .kind = kSectionList,
        .range = {.min = 1, .max = 64},
        .section = &kLoadChangeSection,
        .about = "Changes of the load while the motor runs, in the order of time. By hand: `rc10ctl load`."},
    Key{.name = "changes_repeat_s",
        .kind = kNumber,
        .unit = "s",
        .range = {.min = 0, .max = 100'000, .above_min = true},
        .about =
            "Period after which the load is as at the start again and the changes begin anew; above the last "
            "after_s. Default: once."}};

constexpr auto simulatedKeys() {
  std::array<Key, kFigures.size() + kOthers.size()> keys{};
  for (std::size_t i = 0; i < kFigures.size(); ++i) keys[i] = kFigures[i];
  for (std::size_t i = 0; i < kOthers.size(); ++i) keys[kFigures.size() + i] = kOthers[i];
  return keys;
}

constexpr auto kSimulatedKeys = simulatedKeys();

}  // namespace

constexpr Section kSimulatedSection{"simulated", kSimulatedKeys, "What hangs on a simulated motor's shaft."};

}  // namespace rc10
