#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace rc10 {

/// Full scale of the fields of a frame: registers 21 to 23 of a Damiao drive. Its own output.
struct DamiaoScale {
  double p_max_rad = 12.5;
  double v_max_rad_s = 30.0;
  double t_max_nm = 10.0;
};

/// Gains of the MIT law, at the drive's own output.
struct DamiaoGains {
  double velocity_damping_nms_per_rad = 0.0;
  double angle_stiffness_nm_per_rad = 0.0;
  double angle_damping_nms_per_rad = 0.0;
};

/// One model of the Damiao DM series. All that differs between models is in this table.
struct DamiaoModel {
  std::string_view name;
  DamiaoScale scale;  ///< As it leaves the factory.
  double gear_ratio = 1.0;
  float torque_nm_per_a = 0.0F;  ///< At the output.
  float current_max_a = 0.0F;    ///< The drive's: 1.0 in its per-unit currents.
  float no_load_rpm = 0.0F;
  float top_rpm = 0.0F;  ///< The same at the highest voltage of its range; 0: no_load_rpm.
  float nominal_v = 24.0F;
  float phase_resistance_ohm = 0.0F;
  float rotor_inertia_kg_m2 = 0.0F;
  bool output_encoder = false;  ///< "2EC": a second encoder knows the angle of the output at power-up.
  DamiaoGains gains;            ///< Defaults.
};

/// All models. Sources stand beside the figures in damiao_model.cpp.
[[nodiscard]] std::span<const DamiaoModel> damiaoModels() noexcept;
/// Their names.
[[nodiscard]] std::span<const std::string_view> damiaoModelNames() noexcept;
/// nullptr if there is no such model.
[[nodiscard]] const DamiaoModel* findDamiaoModel(std::string_view name) noexcept;

/// Fastest speed of the drive's output that its feedback can tell: beyond v_max by counting wraps.
[[nodiscard]] double damiaoFastestRadS(const DamiaoModel& model, const DamiaoScale& scale) noexcept;

/// The drive's mode of control, register 10. The numbers are the drive's.
enum class DamiaoControl : std::uint8_t {
  kMit = 1,
  kPositionVelocity = 2,
  kVelocity = 3,
  kForcePosition = 4
};

/// As written in the configuration; in the order of the numbers.
inline constexpr std::array<std::string_view, 4> kDamiaoControlNames{"mit", "position_velocity", "velocity",
                                                                     "force_position"};
/// kMit for what is none of them.
[[nodiscard]] DamiaoControl damiaoControl(std::string_view name) noexcept;

}  // namespace rc10
