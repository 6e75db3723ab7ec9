#include "drives/damiao/damiao_model.hpp"

#include <algorithm>

#include "app/units.hpp"
#include "motor/model_table.hpp"
#include "motor/wrapped_speed.hpp"

// Scales, ratios, torque constants, drive currents, speeds, resistances and inertias are those of the table
// that Seeed publishes (wiki.seeedstudio.com/damiao_series), if nothing else is said. Where the libraries
// differ about a scale, the drive decides: it is read before enabling and held against this.
namespace rc10 {
namespace {

constexpr float kSmallDriveA = 10.261194F;   // "Imax" of the drives of 35 and 43 mm
constexpr float kMiddleDriveA = 20.522388F;  // 60 mm
constexpr float kLargeDriveA = 41.044776F;   // 80 mm

// Gains: chosen. An angle settles without overshoot with about the rotor's own inertia as load, tuned on the
// simulation; a heavy joint needs more. The drive takes at most 500 and 5.
constexpr DamiaoGains kSmallGains{1.0, 20.0, 1.0};
constexpr DamiaoGains kGearedGains{4.0, 60.0, 4.0};
constexpr DamiaoGains kLargeGains{4.0, 100.0, 5.0};
constexpr DamiaoGains kDirectGains{0.5, 5.0, 0.3};
constexpr DamiaoGains kHubGains{0.02, 0.5, 0.01};

// No torque constant is published for these: as if full scale of torque were full current. Their currents
// are shares of that, their torques are right.
constexpr float fullScaleTorque(float t_max_nm, float current_max_a) { return t_max_nm / current_max_a; }

constexpr std::array kDamiaoModels{
    DamiaoModel{.name = "DM3507",
                .scale = {12.566, 50.0, 5.0},  // the vendor's C++ routine has 10 Nm; its drive says 5
                .gear_ratio = 7.0,
                .torque_nm_per_a = 0.5439F,
                .current_max_a = kSmallDriveA,
                .no_load_rpm = 460.0F,
                .phase_resistance_ohm = 0.8F,
                .rotor_inertia_kg_m2 = 8.7e-6F,
                .output_encoder = true,
                .gains = {0.5, 10.0, 0.5}},
    DamiaoModel{.name = "DM4310",
                .scale = {12.5, 30.0, 10.0},
                .gear_ratio = 10.0,
                .torque_nm_per_a = 0.945F,
                .current_max_a = kSmallDriveA,
                .no_load_rpm = 200.0F,
                .phase_resistance_ohm = 0.85F,
                .rotor_inertia_kg_m2 = 1.8e-5F,
                .output_encoder = true,
                .gains = kSmallGains},
    DamiaoModel{.name = "DM4310_48V",
                .scale = {12.5, 50.0, 10.0},  // Seeed: 30 rad/s
                .gear_ratio = 10.0,
                .torque_nm_per_a = 0.945F,
                .current_max_a = kSmallDriveA,
                .no_load_rpm = 400.0F,
                .nominal_v = 48.0F,
                .phase_resistance_ohm = 0.85F,
                .rotor_inertia_kg_m2 = 1.8e-5F,
                .output_encoder = true,
                .gains = kSmallGains},
    DamiaoModel{.name = "DM4340",
                .scale = {12.5, 10.0, 28.0},  // cmjang, Seeed: 8 rad/s; jia-xie, drive: 10
                .gear_ratio = 40.0,
                .torque_nm_per_a = 4.074F,
                .current_max_a = kSmallDriveA,
                .no_load_rpm = 52.5F,
                .phase_resistance_ohm = 0.88F,
                .rotor_inertia_kg_m2 = 2.0e-5F,
                .output_encoder = true,
                .gains = kGearedGains},
    DamiaoModel{.name = "DM4340_48V",
                .scale = {12.5, 10.0, 28.0},  // vendor's routine; Seeed 8, a recent drive 20
                .gear_ratio = 40.0,
                .torque_nm_per_a = 4.074F,
                .current_max_a = kSmallDriveA,
                .no_load_rpm = 100.0F,
                .nominal_v = 48.0F,
                .phase_resistance_ohm = 0.88F,
                .rotor_inertia_kg_m2 = 2.0e-5F,
                .output_encoder = true,
                .gains = kGearedGains},
    DamiaoModel{.name = "DM6006",
                .scale = {12.5, 45.0, 20.0},  // the vendor's C++ routine has 12 Nm
                .gear_ratio = 6.0,
                .torque_nm_per_a = 0.7308F,
                .current_max_a = kMiddleDriveA,
                .no_load_rpm = 226.0F,
                .top_rpm = 408.0F,  // at 48 V
                .phase_resistance_ohm = 0.435F,
                .rotor_inertia_kg_m2 = 5.8e-5F,
                .output_encoder = true,
                .gains = {1.5, 30.0, 1.5}},
    DamiaoModel{.name = "DM6248P",  // jia-xie alone; ratio by its name, drive as for 60 mm: assumed
                .scale = {12.566, 20.0, 120.0},
                .gear_ratio = 48.0,
                .torque_nm_per_a = fullScaleTorque(120.0F, kMiddleDriveA),
                .current_max_a = kMiddleDriveA,
                .output_encoder = true,
                .gains = kLargeGains},
    DamiaoModel{.name = "DM8006",
                .scale = {12.5, 45.0, 40.0},  // the vendor's C++ routine has 20 Nm
                .gear_ratio = 6.0,
                .torque_nm_per_a = 1.0206F,
                .current_max_a = kLargeDriveA,
                .no_load_rpm = 194.2F,
                .top_rpm = 392.8F,  // at 48 V
                .phase_resistance_ohm = 0.4F,
                .rotor_inertia_kg_m2 = 1.15e-4F,
                .output_encoder = true,
                .gains = {3.0, 60.0, 3.0}},
    DamiaoModel{.name = "DM8009",
                .scale = {12.5, 45.0, 54.0},
                .gear_ratio = 9.0,
                .torque_nm_per_a = 1.261575F,
                .current_max_a = kLargeDriveA,
                .no_load_rpm = 168.0F,
                .top_rpm = 335.0F,  // at 48 V
                .phase_resistance_ohm = 0.145F,
                .rotor_inertia_kg_m2 = 1.95e-4F,
                .output_encoder = true,
                .gains = kLargeGains},
    DamiaoModel{.name = "DM10010",
                .scale = {12.5, 20.0, 200.0},
                .gear_ratio = 10.0,
                .torque_nm_per_a = 2.59875F,
                .current_max_a = 100.0F,
                .no_load_rpm = 75.0F,
                .top_rpm = 150.0F,  // at 48 V
                .phase_resistance_ohm = 0.125F,
                .rotor_inertia_kg_m2 = 5.5e-4F,
                .output_encoder = true,
                .gains = kLargeGains},
    DamiaoModel{.name = "DM10010L",
                .scale = {12.5, 25.0, 200.0},
                .gear_ratio = 10.0,
                .torque_nm_per_a = 2.00025F,
                .current_max_a = 99.7F,
                .no_load_rpm = 100.0F,
                .top_rpm = 200.0F,  // at 48 V
                .phase_resistance_ohm = 0.11F,
                .rotor_inertia_kg_m2 = 5.56e-4F,
                .output_encoder = true,
                .gains = kLargeGains},
    // Direct drives: scales by the vendor's library and jia-xie; no more is published. Their manuals do not
    // speak of an angle that outlives the power supply.
    DamiaoModel{.name = "DMH3510",
                .scale = {12.5, 280.0, 1.0},
                .torque_nm_per_a = fullScaleTorque(1.0F, kSmallDriveA),
                .current_max_a = kSmallDriveA,
                .gains = kHubGains},
    DamiaoModel{.name = "DMH6215",
                .scale = {12.5, 45.0, 10.0},
                .torque_nm_per_a = fullScaleTorque(10.0F, kSmallDriveA),
                .current_max_a = kSmallDriveA,
                .gains = kDirectGains},
    DamiaoModel{.name = "DMG6220",
                .scale = {12.5, 45.0, 10.0},
                .torque_nm_per_a = fullScaleTorque(10.0F, kSmallDriveA),
                .current_max_a = kSmallDriveA,
                .gains = kDirectGains},
};

constexpr auto kDamiaoNames = modelNames(kDamiaoModels);

}  // namespace

std::span<const DamiaoModel> damiaoModels() noexcept { return kDamiaoModels; }

std::span<const std::string_view> damiaoModelNames() noexcept { return kDamiaoNames; }

const DamiaoModel* findDamiaoModel(std::string_view name) noexcept { return findModel(kDamiaoModels, name); }

double damiaoFastestRadS(const DamiaoModel& model, const DamiaoScale& scale) noexcept {
  const auto top_rpm = static_cast<double>(std::max(model.no_load_rpm, model.top_rpm));
  return std::max(scale.v_max_rad_s, kWrapReach * top_rpm * kRadPerSPerRpm);
}

DamiaoControl damiaoControl(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kDamiaoControlNames.size(); ++i) {
    if (kDamiaoControlNames[i] == name) return static_cast<DamiaoControl>(i + 1);
  }
  return DamiaoControl::kMit;
}

}  // namespace rc10
