#include "drives/dji/dji_simulated_parameters.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <string_view>

#include "app/units.hpp"
#include "sim/drive.hpp"

namespace rc10::sim {
namespace {

constexpr double kSupplyV = 24.0;

/// Physical data beyond the model table. Manuals: M3508 V1.0, M2006-P36, GM6020 v1.2.
struct MotorData {
  std::string_view model;
  double resistance_ohm;
  double speed_torque_rpm_per_nm;  ///< Manual, at the output of the model's own gear.
  double mechanical_lag_s;         ///< Manual.
  double no_load_input_a;          ///< Manual, into the drive at 24 V.
  double current_lag_s;
  double winding_lag_s;
  double rated_a;                ///< Manual's rated torque over Kt.
  double heat_capacity_j_per_k;  ///< Estimated: winding and stator, 0.4 J/(g K) on most of the mass.
  double load_ratio;             ///< Default load inertia over the rotor's, both at the output.
};

// Resistance: the manual's phase resistance, with which the rated points come out within 10 %. Except the
// GM6020's: its rated point (1.2 N m at 132 rpm) and its slope of 156 rpm/(N m) agree on 8.7 ohm between
// supply and back-EMF, not on the 1.8 ohm of one phase. Taken is 8.0 ohm, so that 24 V drive the full 3 A.
// Current loop: 0.3 ms is a bandwidth of 500 Hz, assumed; nothing is published. Winding: L/R.
// Load ratio: a wheel off the ground, a small mechanism, a light gimbal. A bare GM6020 is too quick for
// any loop at 1 kHz.
constexpr std::array kMotorData{MotorData{.model = "M3508",
                                          .resistance_ohm = 0.194,
                                          .speed_torque_rpm_per_nm = 72.0,
                                          .mechanical_lag_s = 0.049,
                                          .no_load_input_a = 0.78,
                                          .current_lag_s = 0.0003,
                                          .winding_lag_s = 0.0005,
                                          .rated_a = 10.0,
                                          .heat_capacity_j_per_k = 120.0,
                                          .load_ratio = 1.0},
                                MotorData{.model = "M2006",
                                          .resistance_ohm = 0.461,
                                          .speed_torque_rpm_per_nm = 110.0,
                                          .mechanical_lag_s = 0.05278,
                                          .no_load_input_a = 0.6,
                                          .current_lag_s = 0.0003,
                                          .winding_lag_s = 0.00014,
                                          .rated_a = 1.0 / 0.18,
                                          .heat_capacity_j_per_k = 30.0,
                                          .load_ratio = 0.5},
                                MotorData{.model = "GM6020",
                                          .resistance_ohm = 8.0,
                                          .speed_torque_rpm_per_nm = 156.0,
                                          .mechanical_lag_s = 0.003,
                                          .no_load_input_a = 0.078,
                                          .current_lag_s = 0.0003,
                                          .winding_lag_s = 0.0007,
                                          .rated_a = 1.62,
                                          .heat_capacity_j_per_k = 150.0,
                                          .load_ratio = 25.0}};

// Share of friction at the shaft in the power a motor draws without load; the rest is the drive's
// own and iron losses. Estimated: an M3508 then starts to turn at 0.37 A and an M2006 at 0.46 A.
constexpr double kNoLoadFrictionShare = 0.6;

const MotorData& dataOf(const DjiModel& model) noexcept {
  for (const auto& data : kMotorData) {
    if (data.model == model.name) return data;
  }
  assert(false && "a model without physics");
  return kMotorData.front();
}

}  // namespace

MotorParameters parametersOf(const DjiModel& model, double gear_ratio, const MotorLoad& load) noexcept {
  const MotorData& data = dataOf(model);
  const double own_gear = model.gear_ratio;
  const double no_load_rad_s = static_cast<double>(model.no_load_rpm) * own_gear * kRadPerSPerRpm;

  MotorParameters p;
  p.gear_ratio = gear_ratio;
  p.torque_nm_per_a = static_cast<double>(model.rotor_torque_nm_per_a);
  p.resistance_ohm = data.resistance_ohm;
  p.current_limit_a = static_cast<double>(model.feedback_full_scale_a);
  p.supply_v = kSupplyV;
  p.current_lag_s = data.current_lag_s;
  p.winding_lag_s = data.winding_lag_s;
  p.speed_lag_s = kSpeedLagSeconds;

  // The manuals' mechanical time constant is J times the slope of speed over torque.
  p.inertia_kg_m2 =
      data.mechanical_lag_s / (data.speed_torque_rpm_per_nm * kRadPerSPerRpm) / (own_gear * own_gear);
  p.output_inertia_kg_m2 =
      orDefault(load.inertia_kg_m2, data.load_ratio * p.inertia_kg_m2 * gear_ratio * gear_ratio);

  // At no-load speed, half of the friction is Coulomb's and half is viscous. The back-EMF is what makes the
  // no-load speed come out. Without its gear (a shooter's wheel) a motor has less friction.
  const double rotor_friction_nm = kNoLoadFrictionShare * kSupplyV * data.no_load_input_a / no_load_rad_s;
  p.back_emf_vs_per_rad =
      (kSupplyV - p.resistance_ohm * rotor_friction_nm / p.torque_nm_per_a) / no_load_rad_s;
  p.output_coulomb_nm = orDefault(load.coulomb_nm, 0.5 * rotor_friction_nm * gear_ratio);
  p.output_viscous_nms_per_rad =
      orDefault(load.viscous_nms_per_rad, 0.5 * rotor_friction_nm / no_load_rad_s * gear_ratio * gear_ratio);
  hang(load, p);

  // At the rated current a motor stays just below the hottest its winding may be.
  p.thermal_resistance_k_per_w = (kWindingC - kRoomC) / (p.resistance_ohm * data.rated_a * data.rated_a);
  p.heat_capacity_j_per_k = data.heat_capacity_j_per_k;
  p.ambient_c = kRoomC;
  return p;
}

}  // namespace rc10::sim
