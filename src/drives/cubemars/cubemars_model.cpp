#include "drives/cubemars/cubemars_model.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "motor/model_table.hpp"
#include "motor/wrapped_speed.hpp"

// Sources. Ranges: CubeMars AK series module driver manual V1.0.8 (MIT table), which TMotorCANControl,
// KMR_CubeMars and cubemars_driver_node repeat; V3: cubemars_driver_node and epicallypowerful. Pole pairs:
// TMotorCANControl, epicallypowerful, cubemars_servo_can; for AK70-10 also foc_encoder_ratio 21 in the
// drive's exported settings (cubemars_hardware, .params). Gear: the number in the name (TMotorCANControl has
// 80 for AK80-64). Torque constants: the vendor's, 60 / (2 pi KV). No-load speed: KV * nominal voltage /
// gear, derived. Where a shop sells other windings under the name, torque_constant_nm_per_a says so.
namespace rc10 {
namespace {

constexpr CubemarsRanges range(double position_rad, double velocity_rad_s, double torque_nm) {
  return {.position_rad = position_rad, .velocity_rad_s = velocity_rad_s, .torque_nm = torque_nm};
}

constexpr std::array kCubemarsModels{
    CubemarsModel{.name = "AK10-9",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.16F,
                  .no_load_rpm = 320.0F,  // KV 60
                  .ranges = range(12.5, 50.0, 65.0)},
    CubemarsModel{.name = "AK60-6",
                  .gear_ratio = 6.0,
                  .pole_pairs = 14,
                  .rotor_torque_nm_per_a = 0.068F,
                  .nominal_v = 24.0F,
                  .no_load_rpm = 560.0F,  // KV 140
                  .ranges = range(12.5, 45.0, 15.0)},
    CubemarsModel{.name = "AK70-10",
                  .gear_ratio = 10.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.095F,
                  .no_load_rpm = 480.0F,            // KV 100
                  .phase_resistance_ohm = 0.0933F,  // foc_motor_r of an exported setting
                  .ranges = range(12.5, 50.0, 25.0)},
    CubemarsModel{.name = "AK80-6",
                  .gear_ratio = 6.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.091F,
                  .no_load_rpm = 800.0F,  // KV 100
                  // Firmware V1.1 has 22.5 rad/s (measured by others): velocity_range_rad_s.
                  .ranges = range(12.5, 76.0, 12.0)},
    CubemarsModel{.name = "AK80-8",
                  .gear_ratio = 8.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.159F,
                  .no_load_rpm = 360.0F,  // KV 60
                  .ranges = range(12.5, 37.5, 32.0)},
    CubemarsModel{.name = "AK80-9",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.091F,  // TMotorCANControl measured 0.115
                  .no_load_rpm = 533.0F,            // KV 100
                  .ranges = range(12.5, 50.0, 18.0)},
    CubemarsModel{.name = "AK80-64",
                  .gear_ratio = 64.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.119F,
                  .no_load_rpm = 60.0F,  // KV 80
                  .ranges = range(12.5, 8.0, 144.0)},
    CubemarsModel{.name = "AK10-9-V3",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 1.1314F / 9.0F,  // measured: cubemars_driver_node
                  .no_load_rpm = 320.0F,
                  .v3 = true,
                  .signed_current = false,  // cubemars_driver_node
                  .ranges = range(12.56, 28.0, 54.0)},
    CubemarsModel{.name = "AK60-6-V3",
                  .gear_ratio = 6.0,
                  .pole_pairs = 14,
                  .rotor_torque_nm_per_a = 0.119F,  // KV 80 (cubemars_servo_can)
                  .no_load_rpm = 640.0F,
                  .v3 = true,
                  .ranges = range(12.56, 60.0, 12.0)},
    CubemarsModel{.name = "AK80-8-V3",
                  .gear_ratio = 8.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 1.0566F / 8.0F,  // measured: cubemars_driver_node
                  .no_load_rpm = 360.0F,
                  .v3 = true,
                  .ranges = range(12.5, 37.5, 32.0)},
    CubemarsModel{.name = "AK80-9-V3",
                  .gear_ratio = 9.0,
                  .pole_pairs = 21,
                  .rotor_torque_nm_per_a = 0.095F,  // cubemars_servo_can
                  .no_load_rpm = 533.0F,
                  .v3 = true,
                  .ranges = range(12.56, 65.0, 18.0)}};

// 6 and 7: the newer manuals and cubemars_driver_node. Older ones call 6 "phase unbalance" and have no 7.
constexpr std::array kCubemarsFaults{
    DriveFault{1, FaultCode::kDriveMotorTooHot, "motor too hot"},
    DriveFault{2, FaultCode::kDriveOverCurrent, "over-current"},
    DriveFault{3, FaultCode::kDriveOverVoltage, "over-voltage"},
    DriveFault{4, FaultCode::kDriveUnderVoltage, "under-voltage"},
    DriveFault{5, FaultCode::kDriveEncoder, "encoder"},
    DriveFault{6, FaultCode::kDriveTooHot, "power stage too hot (older firmware: phase unbalance)"},
    DriveFault{7, FaultCode::kDriveStalled, "motor stalled"}};

double messageDegPerDeg(const CubemarsModel& model, int pole_pairs, std::string_view basis) noexcept {
  if (basis == "rotor") return model.gear_ratio;
  if (basis == "electrical") return model.gear_ratio * std::max(pole_pairs, 1);
  return 1.0;
}

}  // namespace

std::span<const CubemarsModel> cubemarsModels() noexcept { return kCubemarsModels; }

std::span<const std::string_view> cubemarsModelNames() noexcept {
  static constexpr auto kNames = modelNames(kCubemarsModels);
  return kNames;
}

const CubemarsModel* findCubemarsModel(std::string_view name) noexcept {
  return findModel(kCubemarsModels, name);
}

CubemarsSettings cubemarsSettings(std::string_view model_name, const OwnValues& own) {
  const CubemarsModel* found = findCubemarsModel(model_name);
  const CubemarsModel& model = found == nullptr ? kCubemarsModels.front() : *found;
  CubemarsSettings settings{.model = &model, .ranges = model.ranges};
  const std::string protocol = own.text("protocol");
  if (protocol == "mit") settings.protocol = CubemarsProtocol::kMit;
  if (protocol == "mit_v3") settings.protocol = CubemarsProtocol::kMitV3;
  settings.pole_pairs = own.integer("pole_pairs") > 0 ? own.integer("pole_pairs") : model.pole_pairs;
  const auto torque_constant = static_cast<float>(own.number("torque_constant_nm_per_a"));
  settings.torque_nm_per_a = (torque_constant > 0.0F ? torque_constant : model.rotor_torque_nm_per_a) *
                             static_cast<float>(model.gear_ratio);
  if (const double range = own.number("velocity_range_rad_s"); range > 0.0)
    settings.ranges.velocity_rad_s = range;
  if (const double range = own.number("torque_range_nm"); range > 0.0) settings.ranges.torque_nm = range;
  settings.message_deg_per_deg = messageDegPerDeg(model, settings.pole_pairs, own.text("position_basis"));
  settings.output_encoder = own.flag("output_encoder");
  return settings;
}

double cubemarsFastestRpm(const CubemarsModel& model) noexcept {
  return kWrapReach * static_cast<double>(model.no_load_rpm);
}

std::span<const DriveFault> cubemarsFaults() noexcept { return kCubemarsFaults; }

FaultCode cubemarsFault(std::uint8_t code) noexcept {
  return code == 0 ? FaultCode::kNone : faultOfCode(kCubemarsFaults, code);
}

}  // namespace rc10
