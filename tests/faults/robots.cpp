#include "faults/robots.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "config/load_config.hpp"

namespace rc10::test {
namespace {

constexpr std::array<std::string_view, kRobotCount> kRobots{R"(
robot: dji
buses:
  - name: chassis
    type: sim
    motors:
      - {name: left, model: M3508, id: 1, reduced_velocity_rpm: 60, reduced_within_ms: 200,
         reduced_current_a: 5, current_limit_a: 10, on_timeout: brake, on_disable: damp, on_estop: brake, brake_max_s: 0.5,
         zero: power_on}
      - {name: right, model: M3508, id: 2, direction: -1, on_timeout: damp, on_disable: ramp, on_estop: damp,
         ramp_s: 0.4, current_slew_a_per_s: 100, velocity_slew_rpm_per_s: 2000}
      - {name: feeder, model: M2006, id: 3, current_limit_a: 5, stall_ms: 200, optional: true}
  - name: arm
    type: sim
    motors:
      - {name: yaw, model: GM6020, id: 5, command: current, current_limit_a: 1.5, on_timeout: damp, on_disable: damp,
         on_estop: damp, angle_min_deg: -90, angle_max_deg: 90, angle_slew_deg_per_s: 360, max_first_step_deg: 30,
         following_error_deg: 30}
      - {name: pitch, model: GM6020, id: 1, command: voltage, voltage_limit_v: 12, on_timeout: hold, on_disable: damp,
         on_estop: brake, hold_max_s: 1, brake_max_s: 0.5}
      - {name: lift, model: M2006, id: 4, current_limit_a: 6, on_timeout: hold, on_disable: hold, on_estop: hold,
         hold_max_s: 0.5, angle_min_deg: 0, angle_max_deg: 2000, stall_ms: 300, stall_action: notify, zero: power_on,
         simulated: {load_torque_nm: 0.3, coulomb_nm: 0.05}}
groups:
  - {name: drive, motors: [left, right, feeder], on_member_offline: stop_group, on_return: rearm_at_rest}
)",
                                                            R"(
robot: springs
buses:
  - name: shoulders
    type: sim
    motors:
      - {name: shoulder, model: DM4310, id: 1, master_id: 17, current_limit_a: 4, velocity_limit_rpm: 100,
         reduced_current_a: 2, reduced_within_ms: 200,
         on_timeout: hold, on_disable: damp, on_estop: brake, hold_max_s: 0.5, brake_max_s: 0.5,
         angle_min_deg: -90, angle_max_deg: 90, zero: power_on}
      - {name: wheel, model: DMH6215, id: 3, master_id: 19, control: velocity, velocity_limit_rpm: 120, direction: -1,
         reduced_velocity_rpm: 20, reduced_within_ms: 200,
         on_timeout: brake, on_estop: ramp}
  - name: elbows
    type: sim
    motors:
      - {name: elbow, model: DM4340, id: 2, master_id: 18, control: position_velocity, velocity_limit_rpm: 30,
         on_timeout: hold, on_disable: hold, on_estop: hold}
      - {name: gripper, model: DM4310, id: 4, master_id: 20, control: force_position, velocity_limit_rpm: 60,
         current_limit_a: 2, reduced_current_a: 1, reduced_within_ms: 200, on_timeout: hold, on_estop: brake}
  - name: knees
    type: sim
    motors:
      - {name: knee, model: RS00, id: 20, reduced_velocity_rpm: 25, reduced_within_ms: 200, reduced_current_a: 3,
         current_limit_a: 6, velocity_limit_rpm: 100, on_timeout: hold, on_disable: damp,
         on_estop: damp, hold_max_s: 1, current_slew_a_per_s: 50}
      - {name: lift, model: RS03, id: 21, control: position, current_limit_a: 10, velocity_limit_rpm: 60, direction: -1,
         on_timeout: hold, on_disable: brake, on_estop: brake}
      - {name: wrist, model: CyberGear, id: 22, current_limit_a: 8, velocity_limit_rpm: 120, on_timeout: damp,
         on_disable: hold, on_estop: damp, hold_max_s: 0.5, angle_min_deg: -90, angle_max_deg: 120, zero: power_on}
  - name: ankles
    type: sim
    motors:
      - {name: ankle, model: AK80-9, id: 31, protocol: mit, current_limit_a: 6, velocity_limit_rpm: 80, on_timeout: damp,
         reduced_current_a: 3, reduced_within_ms: 200,
         on_disable: brake, on_estop: hold, hold_max_s: 0.5, angle_min_deg: -120, angle_max_deg: 120, zero: power_on}
      - {name: hip, model: AK80-9, id: 32, reduced_velocity_rpm: 20, reduced_within_ms: 200, reduced_current_a: 4,
         current_limit_a: 8, velocity_limit_rpm: 80, on_timeout: brake,
         on_disable: damp, on_estop: ramp, ramp_s: 0.5, current_slew_a_per_s: 40}
groups:
  - {name: leg, motors: [knee, ankle], on_member_offline: stop_group, on_return: rearm_at_rest}
)",
                                                            R"(
robot: loops
buses:
  - name: belts
    type: sim
    motors:
      - {name: belt, model: ODrive_S1, id: 3, reduced_velocity_rpm: 60, reduced_within_ms: 200, reduced_current_a: 10,
         torque_constant_nm_per_a: 0.0551, current_limit_a: 20,
         velocity_limit_rpm: 600, on_timeout: brake, on_disable: ramp, on_estop: brake, brake_max_s: 0.5,
         feedback_hz: 200}
      - {name: winch, model: ODrive_v3, id: 4, torque_constant_nm_per_a: 0.04, current_limit_a: 15,
         velocity_limit_rpm: 400, direction: -1, gear_ratio: 4, on_timeout: hold, on_estop: hold, hold_max_s: 0.5,
         feedback_hz: 200, telemetry_hz: 100, current_slew_a_per_s: 100}
  - name: shooters
    type: sim
    motors:
      - {name: shooter, model: VESC, id: 10, pole_pairs: 7, angle: none, motor_current_max_a: 40, current_limit_a: 30,
         reduced_velocity_rpm: 300, reduced_within_ms: 200, reduced_current_a: 15,
         velocity_limit_rpm: 3000, kv_rpm_per_v: 190, on_timeout: damp, on_disable: brake, on_estop: ramp,
         feedback_hz: 200, current_slew_a_per_s: 200}
      - {name: steer, model: VESC, id: 11, pole_pairs: 7, motor_current_max_a: 20, current_limit_a: 10, gear_ratio: 10,
         velocity_limit_rpm: 200, relative_current: true, on_timeout: hold, on_disable: damp, on_estop: damp,
         kv_rpm_per_v: 190, feedback_hz: 200, angle_min_deg: -180, angle_max_deg: 180, zero: power_on, direction: -1}
      - {name: mast, model: VESC, id: 12, pole_pairs: 7, angle: encoder, current_limit_a: 10, velocity_limit_rpm: 200,
         kv_rpm_per_v: 190, feedback_hz: 200, on_timeout: hold, on_disable: damp, on_estop: hold, hold_max_s: 0.5,
         angle_min_deg: -120, angle_max_deg: 120}
  - name: legs
    type: sim
    data_bitrate: 5000000
    motors:
      - {name: calf, model: moteus, id: 1, reduced_velocity_rpm: 30, reduced_within_ms: 200, reduced_current_a: 5,
         motor_kv_rpm_per_v: 100, current_limit_a: 10, velocity_limit_rpm: 300,
         on_timeout: hold, on_disable: ramp, on_estop: damp, hold_max_s: 0.5, current_slew_a_per_s: 50}
      - {name: thigh, model: moteus, id: 2, motor_kv_rpm_per_v: 100, current_limit_a: 15, velocity_limit_rpm: 200,
         direction: -1, on_timeout: brake, on_disable: damp, on_estop: hold, command_divider: 2,
         angle_min_deg: -120, angle_max_deg: 120, zero: power_on}
groups:
  - {name: legs, motors: [calf, thigh], on_member_offline: stop_group, on_return: rearm_at_rest}
)",
                                                            R"(
robot: asked
buses:
  - name: wheels
    type: sim
    motors:
      - {name: left_wheel, model: LK-MF9025, id: 1, group: true, current_limit_a: 8, current_slew_a_per_s: 40}
      - {name: right_wheel, model: LK-MF9025, id: 2, group: true, current_limit_a: 8, direction: -1}
  - name: pans
    type: sim
    motors:
      - {name: pan, model: LK-MG5010E-i10, id: 5, reduced_velocity_rpm: 20, reduced_within_ms: 200, reduced_current_a: 2,
         velocity_limit_rpm: 100, current_limit_a: 5, on_timeout: ramp,
         ramp_s: 0.3, on_disable: brake, on_estop: brake, zero_deg: 30, angle_min_deg: -150, angle_max_deg: 150}
      - {name: tilt, model: LK-MG5010E-i10, id: 6, velocity_limit_rpm: 100, on_timeout: hold, on_estop: hold,
         hold_max_s: 0.5, direction: -1, command_divider: 2}
  - name: tables
    type: sim
    motors:
      - {name: turntable, model: RMD-X8-20, id: 22, reduced_velocity_rpm: 15, reduced_within_ms: 200, reduced_current_a: 3,
         current_limit_a: 6, velocity_limit_rpm: 60, on_timeout: damp,
         on_disable: brake, on_estop: brake, current_slew_a_per_s: 40, command_divider: 2}
      - {name: shoulder, model: RMD-X8-25, id: 23, velocity_limit_rpm: 40, direction: -1, on_timeout: hold,
         on_disable: damp, on_estop: damp, hold_max_s: 0.5, command_divider: 2, angle_min_deg: -120,
         angle_max_deg: 120, zero: power_on}
groups:
  - {name: wheels, motors: [left_wheel, right_wheel], together: true, on_return: rearm_at_rest}
)",
                                                            R"(
robot: parts
buses:
  - name: wheels
    type: sim
    motors:
      - {name: front_left, model: M3508, reduced_velocity_rpm: 60, reduced_within_ms: 200,
         id: 1, current_limit_a: 8, on_timeout: damp, on_disable: damp, on_estop: brake, brake_max_s: 0.5, stall_ms: 100}
      - {name: front_right, model: M3508, reduced_velocity_rpm: 60, reduced_within_ms: 200,
         id: 2, current_limit_a: 8, on_timeout: damp, on_disable: damp, on_estop: brake}
      - {name: rear_left, model: M3508, reduced_velocity_rpm: 60, reduced_within_ms: 200,
         id: 3, current_limit_a: 8, on_timeout: damp, on_disable: damp, on_estop: brake}
      - {name: rear_right, model: M3508, reduced_velocity_rpm: 60, reduced_within_ms: 200,
         id: 4, current_limit_a: 8, on_timeout: damp, on_disable: damp, on_estop: brake}
  - name: top
    type: sim
    motors:
      - {name: feeder, model: M2006, id: 1, current_limit_a: 5, on_timeout: brake, stall_ms: 100}
      - {name: arm, model: M3508, id: 2, current_limit_a: 8, on_timeout: damp, on_disable: damp, on_estop: damp,
         reduced_velocity_rpm: 30, reduced_within_ms: 200, angle_min_deg: 0, angle_max_deg: 150,
         current_slew_a_per_s: 20, simulated: {stop_min_deg: -60, stop_max_deg: 110, gravity_nm: 0.3}}
      - {name: lift_left, model: RMD-X8-20, id: 22, current_limit_a: 6, velocity_limit_rpm: 60, on_timeout: hold,
         on_disable: brake, on_estop: brake, hold_max_s: 1, command_divider: 2, zero: power_on}
      - {name: lift_right, model: RMD-X8-20, id: 23, current_limit_a: 6, velocity_limit_rpm: 60, on_timeout: hold,
         on_disable: brake, on_estop: brake, hold_max_s: 1, command_divider: 2, zero: power_on}
)",
                                                            R"(
robot: slewed
buses:
  - name: knees
    type: sim
    motors:
      - {name: knee, model: RS00, command_divider: 2, id: 20, control: current, current_limit_a: 6,
         velocity_limit_rpm: 100, current_slew_a_per_s: 30, angle_min_deg: -120, angle_max_deg: 120}
      - {name: roller, model: RS03, command_divider: 2, id: 21, control: velocity, current_limit_a: 10,
         velocity_limit_rpm: 80, velocity_slew_rpm_per_s: 200, direction: -1, on_timeout: brake, on_disable: ramp, on_estop: brake}
      - {name: thigh, model: RS00, command_divider: 2, id: 22, current_limit_a: 8, velocity_limit_rpm: 100, current_slew_a_per_s: 40,
         velocity_slew_rpm_per_s: 300, angle_slew_deg_per_s: 200, angle_min_deg: -150, angle_max_deg: 150,
         on_timeout: hold, on_disable: damp, on_estop: damp, max_first_step_deg: 60,
         reduced_velocity_rpm: 25, reduced_within_ms: 400}
      - {name: crank, model: RS03, command_divider: 2, id: 23, control: position, current_limit_a: 10, velocity_limit_rpm: 60,
         angle_slew_deg_per_s: 150, on_timeout: hold}
  - name: ankles
    type: sim
    motors:
      - {name: ankle, model: AK10-9-V3, command_divider: 2, id: 31, protocol: mit_v3, current_limit_a: 8, velocity_limit_rpm: 100,
         velocity_slew_rpm_per_s: 300, angle_slew_deg_per_s: 200, angle_min_deg: -100, angle_max_deg: 160,
         current_slew_a_per_s: 50, on_timeout: damp, on_disable: brake, on_estop: hold, hold_max_s: 0.5}
      - {name: toe, model: AK80-9, command_divider: 2, id: 32, current_limit_a: 8, velocity_limit_rpm: 80, angle_min_deg: -100,
         angle_max_deg: 100, angle_slew_deg_per_s: 200, velocity_slew_rpm_per_s: 150, on_timeout: brake}
  - name: shoulders
    type: sim
    motors:
      - {name: shoulder, model: DM4310, command_divider: 2, id: 1, master_id: 17, current_limit_a: 4, velocity_limit_rpm: 100,
         current_slew_a_per_s: 20, velocity_slew_rpm_per_s: 300, angle_slew_deg_per_s: 200, on_timeout: hold,
         on_disable: damp, on_estop: brake, hold_max_s: 0.5, angle_min_deg: -90, angle_max_deg: 200}
      - {name: wheel, model: DMH6215, command_divider: 2, id: 3, master_id: 19, control: velocity, velocity_limit_rpm: 120,
         velocity_slew_rpm_per_s: 250, direction: -1, on_timeout: brake, on_estop: ramp}
      - {name: elbow, model: DM4340, command_divider: 2, id: 2, master_id: 18, control: position_velocity, velocity_limit_rpm: 30,
         angle_slew_deg_per_s: 100, on_timeout: hold, on_disable: brake, on_estop: hold}
  - name: head
    type: sim
    motors:
      - {name: yaw, model: GM6020, id: 5, angle_min_deg: -90, angle_max_deg: 200, velocity_slew_rpm_per_s: 500,
         angle_slew_deg_per_s: 300, on_timeout: hold, on_estop: damp}
)",
                                                            R"(
robot: slewed_loops
buses:
  - name: belts
    type: sim
    motors:
      - {name: belt, model: ODrive_S1, command_divider: 2, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 20,
         velocity_limit_rpm: 600, feedback_hz: 200, zero: power_on, angle_min_deg: -400, angle_max_deg: 400,
         velocity_slew_rpm_per_s: 1000, angle_slew_deg_per_s: 900, current_slew_a_per_s: 60, on_timeout: brake,
         reduced_velocity_rpm: 60, reduced_within_ms: 700}
      - {name: shooter, model: VESC, id: 10, pole_pairs: 7, current_limit_a: 30, velocity_limit_rpm: 3000,
         kv_rpm_per_v: 190, feedback_hz: 200, velocity_slew_rpm_per_s: 4000, angle_slew_deg_per_s: 900,
         zero: power_on, on_timeout: damp, on_estop: ramp}
  - name: legs
    type: sim
    data_bitrate: 5000000
    motors:
      - {name: calf, model: moteus, id: 1, motor_kv_rpm_per_v: 100, current_limit_a: 10, velocity_limit_rpm: 300,
         absolute: true, velocity_slew_rpm_per_s: 600, angle_slew_deg_per_s: 500, current_slew_a_per_s: 40,
         angle_min_deg: -120, angle_max_deg: 100, on_timeout: hold, on_estop: damp, hold_max_s: 0.5}
  - name: tables
    type: sim
    motors:
      - {name: turntable, model: RMD-X8-20, id: 22, absolute_encoder: true, current_limit_a: 6, velocity_limit_rpm: 60,
         command_divider: 2, velocity_slew_rpm_per_s: 200, angle_slew_deg_per_s: 150, current_slew_a_per_s: 30, on_timeout: damp,
         on_disable: brake, on_estop: brake}
      - {name: pan, model: LK-MG5010E-i10, id: 5, velocity_limit_rpm: 100, current_limit_a: 5, command_divider: 2,
         velocity_slew_rpm_per_s: 200, angle_slew_deg_per_s: 200, on_timeout: ramp, ramp_s: 0.3}
)",
                                                            R"(
robot: driven
buses:
  - name: wheels
    type: sim
    motors:
      - {name: drive_front_left, model: M3508, id: 1, current_limit_a: 8, on_timeout: damp}
      - {name: drive_front_right, model: M3508, id: 2, current_limit_a: 8, on_timeout: damp}
      - {name: drive_rear_left, model: M3508, id: 3, current_limit_a: 8, on_timeout: damp}
      - {name: drive_rear_right, model: M3508, id: 4, current_limit_a: 8, on_timeout: damp}
  - name: axes
    type: sim
    motors:
      - {name: steer_front_left, model: GM6020, id: 1, on_timeout: hold, hold_max_s: 0.5}
      - {name: steer_front_right, model: GM6020, id: 2, on_timeout: hold, hold_max_s: 0.5}
      - {name: steer_rear_left, model: GM6020, id: 3, on_timeout: hold, hold_max_s: 0.5}
      - {name: steer_rear_right, model: GM6020, id: 4, on_timeout: hold, hold_max_s: 0.5}
  - name: turret
    type: sim
    motors:
      - {name: yaw, model: GM6020, id: 1, on_timeout: damp, on_estop: damp, angle_min_deg: -170,
         angle_max_deg: 170, reduced_velocity_rpm: 30, reduced_within_ms: 200}
      - {name: pitch, model: GM6020, id: 2, on_timeout: hold, hold_max_s: 1, angle_min_deg: -30, angle_max_deg: 40}
modules:
  - {name: imu, type: imu, protocol: inputs}
  - name: turret
    type: gimbal
    yaw: yaw
    pitch: pitch
    imu_yaw: imu.yaw_deg
    imu_yaw_rate: imu.yaw_rate_deg_s
    silence_max_s: 1
  - name: base
    type: swerve_chassis
    drive: {front_left: drive_front_left, front_right: drive_front_right, rear_left: drive_rear_left,
            rear_right: drive_rear_right}
    steer: {front_left: steer_front_left, front_right: steer_front_right, rear_left: steer_rear_left,
            rear_right: steer_rear_right}
    wheel_radius_m: 0.06
    track_m: 0.4
    wheelbase_m: 0.4
    max_speed_m_s: 2
    max_turn_deg_s: 180
    max_acceleration_m_s2: 3
    max_turn_acceleration_deg_s2: 360
)",
                                                            R"(
robot: rolling
buses:
  - name: wheels
    type: sim
    motors:
      - {name: wheel_left, model: M3508, id: 1, current_limit_a: 8, on_timeout: damp, on_estop: brake, brake_max_s: 0.3}
      - {name: wheel_right, model: M3508, id: 2, current_limit_a: 8, on_timeout: damp, on_estop: brake}
      - {name: wheel_middle, model: M2006, id: 3, current_limit_a: 5, on_timeout: damp, on_estop: brake}
  - name: tracks
    type: sim
    motors:
      - {name: track_left, model: VESC, id: 10, pole_pairs: 7, kv_rpm_per_v: 190, current_limit_a: 20,
         velocity_limit_rpm: 600, on_timeout: damp, on_disable: brake, on_estop: ramp, ramp_s: 0.5,
         reduced_velocity_rpm: 100, reduced_within_ms: 200}
      - {name: track_right, model: VESC, id: 11, pole_pairs: 7, kv_rpm_per_v: 190, current_limit_a: 20,
         velocity_limit_rpm: 600, on_timeout: damp, on_disable: brake, on_estop: ramp, ramp_s: 0.5, direction: -1,
         reduced_velocity_rpm: 100, reduced_within_ms: 200}
modules:
  - name: base
    type: omni3_chassis
    wheels: {left: wheel_left, right: wheel_right, middle: wheel_middle}
    wheel_radius_m: 0.05
    centre_distance_m: 0.2
    max_speed_m_s: 2
    max_turn_deg_s: 180
    max_acceleration_m_s2: 3
    max_turn_acceleration_deg_s2: 360
  - name: carrier
    type: differential_chassis
    wheels: {left: track_left, right: track_right}
    wheel_radius_m: 0.06
    track_m: 0.4
    max_speed_m_s: 2
    max_turn_deg_s: 180
    max_acceleration_m_s2: 3
    max_turn_acceleration_deg_s2: 360
)"};

constexpr std::size_t kParts = 4;  ///< Place in kRobots of the robot whose modules are below.

// A robot for a contest: all families, defaults wherever there is one, the reasons to stop that a team
// switches on.
constexpr std::string_view kMatch = R"(
robot: match
buses:
  - name: chassis
    type: sim
    motors:
      - {name: front_left, model: M3508, id: 1, on_timeout: damp, on_disable: damp, on_estop: brake, zero: power_on,
         stall_ms: 500}
      - {name: front_right, model: M3508, id: 2, on_timeout: damp, on_disable: damp, on_estop: brake, zero: power_on,
         stall_ms: 500}
      - {name: rear_left, model: M3508, id: 3, on_timeout: damp, on_disable: damp, on_estop: brake, zero: power_on,
         stall_ms: 500}
      - {name: rear_right, model: M3508, id: 4, on_timeout: damp, on_disable: damp, on_estop: brake, zero: power_on,
         stall_ms: 500}
      - {name: loader, model: M2006, id: 5, current_limit_a: 5, zero: power_on, stall_ms: 500}
  - name: turret
    type: sim
    motors:
      - {name: yaw, model: GM6020, id: 5, on_timeout: hold, angle_slew_deg_per_s: 360, stall_ms: 500,
         following_error_deg: 45, angle_min_deg: -170, angle_max_deg: 170, temperature_derate_c: 80}
      - {name: pitch, model: GM6020, id: 6, on_timeout: hold, angle_min_deg: -30, angle_max_deg: 40, stall_ms: 500,
         simulated: {gravity_nm: 0.3, hangs_at_deg: -90}}
      - {name: flywheel_left, model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, command_divider: 10,
         on_estop: brake, on_disable: brake}
      - {name: flywheel_right, model: VESC, id: 11, pole_pairs: 7, velocity_limit_rpm: 3000, direction: -1,
         command_divider: 10, on_estop: brake, on_disable: brake}
      - {name: belt, model: ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 20,
         velocity_limit_rpm: 600, command_divider: 10, feedback_hz: 100, on_estop: brake, on_disable: brake}
  - name: arm
    type: sim
    motors:
      - {name: shoulder, model: DM4340, id: 1, master_id: 17, on_timeout: hold, on_estop: damp,
         on_disable: damp, command_divider: 5, angle_min_deg: -100, angle_max_deg: 100, following_error_deg: 45,
         angle_slew_deg_per_s: 200, stall_ms: 500, simulated: {gravity_nm: 3}}
      - {name: elbow, model: DM4310, id: 2, master_id: 18, on_timeout: hold, on_estop: damp, stall_ms: 500,
         on_disable: damp, command_divider: 5, simulated: {gravity_nm: 1}}
      - {name: wrist, model: RS00, id: 20, on_timeout: hold, command_divider: 10, stall_ms: 500}
      - {name: finger, model: AK80-9, protocol: mit, id: 21, on_timeout: hold, command_divider: 10, stall_ms: 500,
         zero: power_on}
      - {name: lift_left, model: RMD-X8-20, id: 22, command_divider: 10, on_timeout: hold, zero: power_on}
      - {name: lift_right, model: RMD-X8-20, id: 23, command_divider: 10, on_timeout: hold, zero: power_on}
      - {name: pan, model: LK-MG5010E-i10, id: 5, command_divider: 10, on_timeout: hold, current_limit_a: 5,
         stall_ms: 500}
  - name: legs
    type: sim
    data_bitrate: 5000000
    motors:
      - {name: leg_left, model: moteus, id: 1, motor_kv_rpm_per_v: 100, command_divider: 2, on_timeout: hold,
         stall_ms: 500}
      - {name: leg_right, model: moteus, id: 2, motor_kv_rpm_per_v: 100, command_divider: 2, direction: -1,
         on_timeout: hold, stall_ms: 500}
groups:
  - {name: reach, motors: [shoulder, elbow], on_member_offline: stop_group}
)";

// Modules of a robot on mecanum wheels, with more keys of its chassis, and the motor of its feeder.
std::string mecanumModules(std::string_view more, std::string_view feeder) {
  constexpr std::string_view kBase = R"(
modules:
  - name: base
    type: mecanum_chassis
    wheels: {front_left: front_left, front_right: front_right, rear_left: rear_left, rear_right: rear_right}
    wheel_radius_m: 0.076
    track_m: 0.4
    wheelbase_m: 0.4
    max_speed_m_s: 2
    max_turn_deg_s: 180
    max_acceleration_m_s2: 3
    max_turn_acceleration_deg_s2: 360
)";
  constexpr std::string_view kRest = R"(, velocity_limit_rpm: 100}
  - {name: lift, type: synchronised_pair, left: lift_left, right: lift_right, velocity_limit_rpm: 40}
)";
  return std::string{kBase}
      .append(more)
      .append("  - {name: gun, type: feeder, motor: ")
      .append(feeder)
      .append(kRest);
}

// Its stop lies beyond its soft limits.
constexpr std::string_view kJoint =
    R"(  - {name: reach, type: joint, motor: arm, homing: stop, max_velocity_deg_s: 120, max_acceleration_deg_s2: 500,
     homing_velocity_rpm: -10, homing_current_a: 2, home_angle_deg: -5, silence_max_s: 2}
)";

RobotConfig parsed(const std::string& text, const std::string& name) {
  auto outcome = parseRobotConfig(text, name);
  if (!outcome) throw std::runtime_error(outcome.errorText());
  return std::move(*outcome.config);
}

}  // namespace

RobotConfig robotOf(std::size_t index) {
  std::string text{kRobots[index]};
  text += "mode_gpio: {chip: gpiochip0, line: 1}\n";
  if (index == kParts) text += mecanumModules("    power_limit_w: 80\n", "feeder") + std::string{kJoint};
  return parsed(text, "chaos.yaml");
}

RobotConfig matchRobot() { return parsed(std::string{kMatch} + mecanumModules("", "loader"), "match.yaml"); }

}  // namespace rc10::test
