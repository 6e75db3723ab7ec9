#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "motor/drive_faults.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// Protocol of the drive: chosen in the vendor's program, not over CAN.
enum class CubemarsProtocol : std::uint8_t {
  kServo,  ///< Extended ids; loops in the drive; speaks unasked.
  kMit,    ///< Drives V1 and V2: standard ids, one answer to each frame.
  kMitV3,  ///< Drives V3: the MIT command in an extended frame, with the servo protocol's feedback.
};

/// Full scale of the fields of a MIT frame, at the drive's own output. Both ways from 0, gains from 0 up.
struct CubemarsRanges {
  double position_rad = 12.5;
  double velocity_rad_s = 50.0;
  double torque_nm = 0.0;
  static constexpr double kStiffnessNmPerRad = 500.0;
  static constexpr double kDampingNmsPerRad = 5.0;
  static constexpr double kDampingStepNmsPerRad = kDampingNmsPerRad / 4095.0;
};

/// Everything in which one AK model differs from another.
struct CubemarsModel {
  std::string_view name;
  double gear_ratio = 1.0;
  int pole_pairs = 0;
  float rotor_torque_nm_per_a = 0.0F;
  float nominal_v = 48.0F;
  float no_load_rpm = 0.0F;  ///< Output shaft, at nominal_v.
  float phase_resistance_ohm = 0.0F;
  bool v3 = false;             ///< Its drive is of the third generation.
  bool signed_current = true;  ///< false: its feedback has only the amount of the current.
  CubemarsRanges ranges;
};

[[nodiscard]] std::span<const CubemarsModel> cubemarsModels() noexcept;
[[nodiscard]] std::span<const std::string_view> cubemarsModelNames() noexcept;
/// nullptr if there is no such model.
[[nodiscard]] const CubemarsModel* findCubemarsModel(std::string_view name) noexcept;

/// A model as it is configured: its table with what the keys change of it.
struct CubemarsSettings {
  const CubemarsModel* model = nullptr;
  CubemarsProtocol protocol = CubemarsProtocol::kServo;
  CubemarsRanges ranges;
  int pole_pairs = 0;
  float torque_nm_per_a = 0.0F;      ///< At the model's own output shaft.
  double message_deg_per_deg = 1.0;  ///< Servo: degrees in a frame per degree of the drive's output.
  bool output_encoder = false;       ///< The drive knows its output angle at power-up.
};

/// `model` is one of cubemarsModels(), `own` has all of the family's keys.
[[nodiscard]] CubemarsSettings cubemarsSettings(std::string_view model, const OwnValues& own);

/// Fastest speed of the drive's own output: above the no-load speed for a load that drives, a full battery,
/// another winding of the same name. More than the default of overspeed_rpm.
[[nodiscard]] double cubemarsFastestRpm(const CubemarsModel& model) noexcept;

/// Native error codes. The words are those of docs/motors/cubemars.md.
[[nodiscard]] std::span<const DriveFault> cubemarsFaults() noexcept;
/// kNone for 0, kDriveOther for a code that the table does not have.
[[nodiscard]] FaultCode cubemarsFault(std::uint8_t code) noexcept;

}  // namespace rc10
