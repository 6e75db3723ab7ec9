#include <array>

#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

constexpr std::array kSimulatedKeys{
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
    Key{.name = "hangs_at_deg",
        .kind = kNumber,
        .unit = "deg",
        .range = {.min = -360'000, .max = 360'000},
        .default_text = "0",
        .about = "Where the arm of gravity_nm hangs at rest."},
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
        .about = "Fraction of the feedback frames that are lost."}};

}  // namespace

constexpr Section kSimulatedSection{"simulated", kSimulatedKeys, "What hangs on a simulated motor's shaft."};

}  // namespace rc10
