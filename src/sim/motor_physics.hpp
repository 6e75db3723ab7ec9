#pragma once

#include <cstdint>
#include <limits>

#include "app/time.hpp"
#include "sim/hand.hpp"

namespace rc10::sim {

inline constexpr double kRoomC = 25.0;  ///< Room temperature of all the manuals' figures.
/// Highest permissible: DJI's M3508 V1.0 and GM6020 v1.2.
inline constexpr double kWindingC = 125.0;
/// The drives do not say how they filter the speed they report; within what the Encoder allows (2 ms).
inline constexpr double kSpeedLagSeconds = 0.001;

/// Parameters of a motor, its drive and its load. SI units; winding and rotor figures are the
/// rotor's, figures named `output_` stand behind the gear.
struct MotorParameters {
  double gear_ratio = 1.0;           ///< Rotor turns per turn of the output shaft.
  double torque_nm_per_a = 0.0;      ///< Kt.
  double back_emf_vs_per_rad = 0.0;  ///< Ke.
  double resistance_ohm = 0.0;       ///< As the supply sees it: the slope of speed over torque.
  double current_limit_a = 0.0;      ///< The drive's maximum.
  double supply_v = 24.0;
  double current_lag_s = 0.0;  ///< Current lag of the drive's current loop.
  double winding_lag_s = 0.0;  ///< L/R: how the current follows a commanded voltage.
  double speed_lag_s = 0.0;    ///< Speed lag of the drive's speed measurement.
  double inertia_kg_m2 = 0.0;
  double output_inertia_kg_m2 = 0.0;  ///< Inertia of the load alone.
  double output_viscous_nms_per_rad = 0.0;
  double output_coulomb_nm = 0.0;  ///< Also holds the shaft at rest.
  double output_load_nm = 0.0;     ///< Constant torque in the negative direction.
  double output_gravity_nm = 0.0;  ///< Times the sine of the angle from where it hangs: negative direction.
  double output_hangs_at_deg = 0.0;
  double output_stop_min_deg = -std::numeric_limits<double>::infinity();
  double output_stop_max_deg = std::numeric_limits<double>::infinity();
  double thermal_resistance_k_per_w = 0.0;
  double heat_capacity_j_per_k = 0.0;
  double ambient_c = kRoomC;

  /// At the output shaft, the rotor's share included.
  [[nodiscard]] double totalInertia() const noexcept {
    return inertia_kg_m2 * gear_ratio * gear_ratio + output_inertia_kg_m2;
  }
};

/// Command for the voltage or current of the winding.
struct WindingCommand {
  enum class Kind : std::uint8_t { kCurrent, kVoltage };
  Kind kind = Kind::kCurrent;
  double value = 0.0;  ///< A or V.
};

/// One motor with its load: state and step. Drives are not coupled, so each steps by itself.
class MotorPhysics {
 public:
  /// Longer steps are cut into equal ones of at most this length.
  static constexpr Duration kLongestStep{std::chrono::microseconds{250}};

  MotorPhysics(const MotorParameters& parameters, double initial_angle_deg) noexcept;

  /// Advances by `dt` with the command held.
  void step(const WindingCommand& command, Duration dt) noexcept;

  /// Another load or friction from now on; angle, current and heat stay as they are. Added inertia is at rest
  /// and slows the shaft; inertia that leaves takes its momentum along.
  void setParameters(const MotorParameters& parameters) noexcept;
  [[nodiscard]] const MotorParameters& parameters() const noexcept { return parameters_; }
  /// A stalled shaft does not turn, whatever the torque.
  void stall(bool stalled) noexcept { stalled_ = stalled; }
  [[nodiscard]] bool stalled() const noexcept { return stalled_; }
  void setTemperature(double temperature_c) noexcept { temperature_c_ = temperature_c; }
  /// A hand takes the shaft; one that has it lets go.
  void take(const Hand& hand) noexcept;
  /// A hand has the shaft.
  [[nodiscard]] bool held() const noexcept { return grip_.held; }

  /// The rotor's position is whole turns and a fraction in [0, 1), so that a long run loses nothing.
  [[nodiscard]] std::int64_t rotorTurns() const noexcept { return rotor_turns_; }
  [[nodiscard]] double rotorFraction() const noexcept { return rotor_fraction_; }
  [[nodiscard]] double rotorRpm() const noexcept;
  [[nodiscard]] double measuredRotorRpm() const noexcept;  ///< As the drive measures it: late.
  [[nodiscard]] double outputAngleDeg() const noexcept;    ///< Multi-turn; 0 is 0, not the start.
  [[nodiscard]] double outputRpm() const noexcept;
  [[nodiscard]] double currentA() const noexcept { return current_a_; }
  [[nodiscard]] double outputTorqueNm() const noexcept;  ///< Torque of the motor, friction not subtracted.
  [[nodiscard]] double temperatureC() const noexcept { return temperature_c_; }
  [[nodiscard]] double kineticEnergyJ() const noexcept;

 private:
  void substep(const WindingCommand& command, double dt_s) noexcept;
  void stepCurrent(const WindingCommand& command, double dt_s) noexcept;
  void stepMotion(double dt_s) noexcept;
  void stepStops() noexcept;
  [[nodiscard]] double stepHand(double dt_s) noexcept;
  void moveHand(double dt_s) noexcept;
  void place(double output_deg) noexcept;
  void stepHeat(double dt_s) noexcept;
  void stepSpeedMeasurement(double dt_s) noexcept;

  MotorParameters parameters_;
  std::int64_t rotor_turns_ = 0;
  double rotor_fraction_ = 0.0;
  double velocity_rad_s_ = 0.0;           // output shaft
  double measured_velocity_rad_s_ = 0.0;  // output shaft
  double current_a_ = 0.0;
  double temperature_c_ = 0.0;
  bool stalled_ = false;
  struct Grip {
    bool held = false;
    double at_deg = 0.0;  ///< Where the hand is.
    double to_deg = 0.0;
    double deg_s = 0.0;  ///< Signed.
    double most_deg_s = 0.0;
    double acceleration_deg_s2 = 0.0;
    double torque_nm = 0.0;
    double left_s = 0.0;  ///< Until it lets go.
  };
  Grip grip_;
};

}  // namespace rc10::sim
