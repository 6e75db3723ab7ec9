#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "support/family_of.hpp"

namespace rc10::test {

/// A motor, in each of the choices of one of its keys.
struct FamilyRow {
  const char* keys;
  const char* varied;  ///< The key; empty: none.
  double rpm = 60.0;
  const char* bus = "";
};

/// The family of a motor whose keys begin with its model.
inline const MotorFamily& familyOfKeys(const std::string& keys) {
  const auto begin = keys.find("model: ") + 7;
  return *familyOf(keys.substr(begin, keys.find(',') - begin)).family;
}

inline std::vector<std::string> variantsOf(const FamilyRow& row) {
  const std::string_view varied = row.varied;
  std::vector<std::string> variants;
  for (const OwnKey& key : familyOfKeys(row.keys).keys()) {
    if (key.name != varied) continue;
    for (const auto choice : key.choices)
      variants.push_back(std::string{row.keys} + ", " + std::string{varied} + ": " + std::string{choice});
  }
  if (variants.empty()) variants.emplace_back(row.keys);
  return variants;
}

/// Motors of all families, in each way to control them and to hear them. A stock VESC lets go below 900 ERPM,
/// where friction stops it, and brakes no faster than its ramp.
inline constexpr FamilyRow kEveryControl[] = {
    {"model: M3508, id: 1", ""},
    {"model: M2006, id: 2", ""},
    {"model: GM6020, id: 5", "command"},
    {"model: VESC, id: 10, pole_pairs: 7, motor_current_max_a: 40, gear_ratio: 50, "
     "velocity_limit_rpm: 100, kv_rpm_per_v: 190, feedback_hz: 500, simulated: {coulomb_nm: 0.5}",
     "angle", 8.0},
    {"model: VESC, id: 11, pole_pairs: 7, gear_ratio: 50, velocity_limit_rpm: 100, current_limit_a: 20, "
     "feedback_hz: 500, simulated: {coulomb_nm: 0.5}",
     "", 8.0},
    {"model: DM4310, id: 1, master_id: 17", "control"},
    {"model: RS00, id: 3", "control"},
    {"model: CyberGear, id: 4", "control"},
    {"model: AK80-9, id: 6", "protocol"},
    {"model: AK10-9-V3, id: 7", "protocol"},
    {"model: moteus, id: 8, motor_kv_rpm_per_v: 100, simulated: {inertia_kg_m2: 0.002}", "", 600.0,
     "data_bitrate: 5000000\n    "},
    {"model: ODrive_S1, id: 9, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
     "simulated: {inertia_kg_m2: 0.002}",
     "", 300.0},
    {"model: ODrive_v3, id: 11, torque_constant_nm_per_a: 0.05, current_limit_a: 20, "
     "velocity_limit_rpm: 600, telemetry_hz: 10, simulated: {inertia_kg_m2: 0.002}",
     "", 300.0},
    {"model: RMD-X8-20, id: 22", ""},
    {"model: RMD-X, id: 23, velocity_limit_rpm: 300, current_limit_a: 10", ""},
    {"model: LK-MG5010E-i10, id: 12, velocity_limit_rpm: 300", ""},
    {"model: LK-MF, id: 13, velocity_limit_rpm: 300", ""},
    {"model: LK-MG5010E-i10, id: 14, velocity_limit_rpm: 300, group: true", ""},
};

}  // namespace rc10::test
