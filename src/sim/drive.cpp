#include "sim/drive.hpp"

#include <cmath>
#include <limits>

namespace rc10::sim {
namespace {

constexpr double kGravityMPerS2 = 9.80665;

/// Unset (NaN) is allowed.
bool negative(float value) noexcept { return value < 0.0F || std::isinf(value); }

}  // namespace

void hang(const MotorLoad& load, MotorParameters& parameters) noexcept {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  parameters.output_load_nm = static_cast<double>(load.load_torque_nm);
  const auto payload_kg = static_cast<double>(load.payload_kg);
  const auto payload_at_m = static_cast<double>(load.payload_at_m);
  parameters.output_inertia_kg_m2 += payload_kg * payload_at_m * payload_at_m;
  parameters.output_gravity_nm =
      static_cast<double>(load.gravity_nm) + payload_kg * kGravityMPerS2 * payload_at_m;
  parameters.output_hangs_at_deg = static_cast<double>(load.hangs_at_deg);
  parameters.output_stop_min_deg = orDefault(load.stop_min_deg, -kNone);
  parameters.output_stop_max_deg = orDefault(load.stop_max_deg, kNone);
}

Result<void> checkLoad(const std::string& name, const MotorLoad& load) {
  const auto refuse = [&](const std::string& why) { return fail("simulated motor '" + name + "': " + why); };
  if (negative(load.inertia_kg_m2)) return refuse("inertia_kg_m2 must not be negative");
  if (negative(load.viscous_nms_per_rad)) return refuse("viscous_nms_per_rad must not be negative");
  if (negative(load.coulomb_nm)) return refuse("coulomb_nm must not be negative");
  if (!std::isfinite(load.load_torque_nm)) return refuse("load_torque_nm must be a number");
  if (!std::isfinite(load.gravity_nm)) return refuse("gravity_nm must be a number");
  if (!std::isfinite(load.hangs_at_deg)) return refuse("hangs_at_deg must be a number");
  if (!(load.payload_kg >= 0.0F) || std::isinf(load.payload_kg))
    return refuse("payload_kg must be a number, not negative");
  if (!(load.payload_at_m >= 0.0F) || std::isinf(load.payload_at_m))
    return refuse("payload_at_m must be a number, not negative");
  if (load.stop_min_deg >= load.stop_max_deg) return refuse("stop_max_deg must be above stop_min_deg");
  if (!std::isfinite(load.initial_angle_deg)) return refuse("initial_angle_deg must be a number");
  const bool is_fraction = load.lost_frames >= 0.0F && load.lost_frames <= 1.0F;  // NaN is none
  if (!is_fraction) return refuse("lost_frames must be 0 to 1");
  return {};
}

}  // namespace rc10::sim
