#pragma once

#include <ostream>
#include <string>

#include "daemon/one_motor_robot.hpp"

namespace rc10::test {

/// A motor whose encoder tells the angle of its shaft within a turn.
struct AbsoluteEncoder {
  const char* name;
  const char* motor;
  double parked_deg = 0.0;  ///< Beside that of the robot.
};

inline void PrintTo(const AbsoluteEncoder& subject, std::ostream* out) { *out << subject.name; }

/// One of each family that has any.
inline constexpr AbsoluteEncoder kAbsoluteEncoders[] = {
    {"Dji", "model: GM6020, id: 1"},
    {"DjiReversed", "model: GM6020, id: 1, direction: -1, zero_deg: 70"},
    {"Damiao", "model: DM4310, id: 1, master_id: 17"},
    {"DamiaoReversed", "model: DM4310, id: 1, master_id: 17, direction: -1, zero_deg: 70"},
    {"RobStride", "model: RS00, id: 3"},
    {"CubeMarsServo", "model: AK80-9, id: 5, output_encoder: true"},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit, output_encoder: true"},
    {"Moteus", "model: moteus, id: 7, motor_kv_rpm_per_v: 100, absolute: true"},
    {"MoteusGeared",
     "model: moteus, id: 7, motor_kv_rpm_per_v: 100, absolute: true, rotor_to_output_ratio: 0.1"},
    {"MyActuator", "model: RMD-X8-20, id: 11, absolute_encoder: true"},
    {"LkTech", "model: LK-MG5010E-i10, id: 12"},
    {"Vesc",
     "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500, angle: encoder"},
};

/// The robot of one motor, parked at an angle of its drive. `keys` begin with a comma, `modules` are
/// whole lines.
inline RobotConfig robotOfArm(const AbsoluteEncoder& subject, const std::string& keys, double parked_deg,
                              const std::string& modules = "") {
  return oneMotorRobot(std::string{subject.motor} + keys + ", simulated: {initial_angle_deg: " +
                           std::to_string(subject.parked_deg + parked_deg) + "}",
                       modules);
}

}  // namespace rc10::test
