#pragma once

#include <string_view>

#include "motor/drive_frames.hpp"
#include "motor/drive_setup.hpp"
#include "motor/motor_base.hpp"
#include "motor/spring_law.hpp"

namespace rc10 {

/// Data of one model for configuration, guards and simulation. Torque and speed at the output shaft of the
/// model's own gear.
struct MotorTraits {
  int min_id = 1;
  int max_id = 127;
  double gear_ratio = 1.0;                    ///< Gear ratio of the model itself.
  CommandUnit effort = CommandUnit::kAmpere;  ///< Unit of effort_limit: A or V.
  float effort_full_scale = 0.0F;             ///< The largest effort that the drive can be told.
  float torque_nm_per_a = 0.0F;               ///< 0: unknown.
  float no_load_rpm = 0.0F;                   ///< At its nominal voltage; 0: unknown.
  /// Fastest that its feedback tells, at the output of the model's own gear; 0: any.
  float reported_rpm = 0.0F;
  float nominal_v = 24.0F;
  float rotor_inertia_kg_m2 = 0.0F;   ///< Inertia of the rotor itself; 0: unknown.
  float phase_resistance_ohm = 0.0F;  ///< 0: unknown.
  bool absolute = false;              ///< Knows the angle of its output at power-up.
  bool reports_temperature = true;
  bool reports_angle = true;
  bool bounds_effort = true;  ///< It can be told a limit of its effort.
  bool scaled_speed = false;  ///< Its speed is a share of a range that depends on the model.
  float frozen_a = 0.0F;      ///< Full scale of the current that it reports; 0: it reports none.
  float signed_a = 0.0F;      ///< Full scale of a current with the sign of the torque; 0: it reports none.
  int signed_current_hz = 0;  ///< Rate at which it reports that; 0: with each feedback.
  int feedback_hz = 1000;     ///< Default.
  int min_feedback_hz = 1;
  int max_feedback_hz = 1000;
  bool asked = false;  ///< Sends only answers: its feedback comes at the command rate.
  /// An asked drive that is silent for longer may have restarted or turned too far to be followed; 0: not
  /// checked against command_divider.
  Duration restart_silence{};
  /// Shortest start of a drive that does not tell that it was restarted: so long a silence ends ACTIVE,
  /// however long feedback_timeout_ms is. 0: it tells.
  Duration unseen_start{};
  /// Key, also set on the drive, that lengthens restart_silence; empty: none.
  std::string_view silence_key{};
  int samples_every = 1;     ///< Turns of an asked drive for each sample of its angle.
  bool fd = false;           ///< Speaks CAN FD.
  int data_bitrate = 0;      ///< Data phase of its CAN FD, as delivered; 0: unknown.
  bool classic_only = true;  ///< Answers FD frames with error frames.
  bool watchdog = false;     ///< The drive's own: stops it without commands; set or verified by enabling.
  ModeSet modes;
  SpringRange spring_range;  ///< Bounds impedance targets, at the output of the model's own gear.
  DriveFrames frames;
  const CascadeConfig* host_loops = nullptr;  ///< Defaults of its loops on the host; null: it has none.
  bool own_velocity_loop = false;             ///< The angle loop alone of host_loops acts.
  const DriveSetup* setup = nullptr;          ///< Settings that can be written; null: none.
  /// Remedy, in words, where a loop of the drive may be at a limit of its current that is not seen; empty:
  /// seen.
  std::string_view unseen_limit_remedy{};
  /// Remedies, in words, where it reports no current with a sign, or no torque; empty: it does.
  std::string_view unreported_current_remedy{};
  std::string_view unreported_torque_remedy{};
  /// Modes whose loop obeys the drive's own maximum of the current, not current_limit_a.
  ModeSet own_loops{};
  /// Key that tells that maximum: what is set on the drive, or current_limit_a, which is to be no higher.
  std::string_view own_limit_key{};
  float own_peak_a = 0.0F;       ///< That maximum as delivered; 0: unknown.
  bool limit_by_report = false;  ///< A loop of the drive is seen at its limit by the current that it reports.
  bool yields = false;           ///< A loop that bounds a force, to be overpowered by a larger one.

  /// Whether its velocity loop runs on the host, as well as its angle loop.
  [[nodiscard]] bool hostVelocityLoop() const noexcept { return host_loops != nullptr && !own_velocity_loop; }
};

}  // namespace rc10
