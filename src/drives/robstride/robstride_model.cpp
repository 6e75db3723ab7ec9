#include "drives/robstride/robstride_model.hpp"

#include <array>
#include <numbers>

#include "motor/model_table.hpp"

namespace rc10 {
namespace {

// The manuals' text says 4 pi, their code 12.57.
constexpr double kTwoTurnsRad = 12.57;
constexpr std::uint16_t kCanTimeout = 0x7028;
constexpr std::uint16_t kCyberGearCanTimeout = 0x200C;
constexpr std::uint8_t kCyclicPosition = 5;
constexpr std::uint8_t kCyberGearPosition = 1;

// The ends of the speed scale lie at the no-load speed (CyberGear: 286 rpm of 296).
constexpr float rpm(double rad_s) {
  const int tenths = static_cast<int>(rad_s * 300.0 / std::numbers::pi);
  const int whole = (tenths + 5) / 10;
  return static_cast<float>(whole);
}

constexpr RobstrideModel robstrideModel(std::string_view name, double velocity_rad_s, double torque_nm,
                                        double stiffness, double damping, double current_a,
                                        double nm_per_arms, double gear_ratio) {
  return {.name = name,
          .position_range_rad = kTwoTurnsRad,
          .velocity_range_rad_s = velocity_rad_s,
          .torque_range_nm = torque_nm,
          .stiffness_range_nm_per_rad = stiffness,
          .damping_range_nms_per_rad = damping,
          .max_current_a = current_a,
          .torque_nm_per_arms = nm_per_arms,
          .gear_ratio = gear_ratio,
          .no_load_rpm = rpm(velocity_rad_s),
          .nominal_v = 48.0F,
          .phase_resistance_ohm = 0.0F,
          // The zero of RS drives survives power-off, and param 0x7029 (zero_sta) chooses between 0 to 2 pi
          // and -pi to pi at power-up: release notes of RS00_0.0.3.5 and .6, gitee.com/robstride. Not tried.
          .absolute = true,
          .watchdog_index = kCanTimeout,
          .position_run_mode = kCyclicPosition,
          .cyber_gear = false};
}

// User manuals RS00-RS06 and EL05 of 2025-12 to 2026-04 (RobStride/Product_Information@ba7236b), CyberGear
// (belovictor/cybergear-docs). Where a vendor's sample code has other ranges, the manual holds. EL05: the
// text allows 6 Nm, the scale ends at 5.5.
constexpr std::array kRobstrideModels{
    robstrideModel("RS00", 33.0, 14.0, 500.0, 5.0, 15.5, 1.48, 10.0),
    robstrideModel("RS01", 44.0, 17.0, 500.0, 5.0, 23.0, 1.22, 7.75),
    robstrideModel("RS02", 44.0, 17.0, 500.0, 5.0, 23.0, 1.22, 7.75),
    robstrideModel("RS03", 20.0, 60.0, 5000.0, 100.0, 43.0, 2.36, 9.0),
    robstrideModel("RS04", 15.0, 120.0, 5000.0, 100.0, 90.0, 2.1, 9.0),
    robstrideModel("RS05", 50.0, 5.5, 500.0, 5.0, 11.0, 0.94, 7.75),
    robstrideModel("RS06", 50.0, 36.0, 5000.0, 100.0, 57.0, 1.09, 9.0),
    robstrideModel("EL05", 50.0, 5.5, 500.0, 5.0, 11.0, 0.94, 9.0),
    RobstrideModel{.name = "CyberGear",
                   // The manual's text says 4 pi, its code and every driver 12.5.
                   .position_range_rad = 12.5,
                   .velocity_range_rad_s = 30.0,
                   .torque_range_nm = 12.0,
                   .stiffness_range_nm_per_rad = 500.0,
                   .damping_range_nms_per_rad = 5.0,
                   .max_current_a = 23.0,
                   .torque_nm_per_arms = 0.87,
                   .gear_ratio = 7.75,
                   .no_load_rpm = 296.0F,
                   .nominal_v = 24.0F,
                   .phase_resistance_ohm = 0.225F,  // half of the 0.45 ohm between two lines
                   .absolute = false,               // its zero is lost at power-off
                   .watchdog_index = kCyberGearCanTimeout,
                   .position_run_mode = kCyberGearPosition,
                   .cyber_gear = true},
};

}  // namespace

double RobstrideModel::torqueNmPerA() const noexcept { return torque_nm_per_arms / std::numbers::sqrt2; }

const RobstrideModel* findRobstrideModel(std::string_view name) noexcept {
  return findModel(kRobstrideModels, name);
}

std::span<const RobstrideModel> robstrideModels() noexcept { return kRobstrideModels; }

std::span<const std::string_view> robstrideModelNames() noexcept {
  static constexpr auto kNames = modelNames(kRobstrideModels);
  return kNames;
}

}  // namespace rc10
