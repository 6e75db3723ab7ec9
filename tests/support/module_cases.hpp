#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rc10::test {

/// One robot for each type of module: some wheels, and the module that drives them.
struct ModuleCase {
  std::string type;
  int motors = 0;    ///< M3508 called m0, m1, ...
  std::string keys;  ///< Keys of the module, in YAML.
  std::vector<std::pair<std::string, double>> inputs{};
  std::vector<std::uint8_t> frame{};  ///< Frame of its serial device.

  [[nodiscard]] std::string yaml() const {
    constexpr int kOnOneBus = 4;  // more at 1 kHz would not fit
    std::string text = "robot: modules\nprofiles: {wheel: {model: M3508, zero: power_on}}\nbuses:\n";
    int next = 0;
    for (int bus = 0; next == 0 || next < motors; ++bus) {
      text += "  - name: bus" + std::to_string(bus) + "\n    type: sim\n    motors:\n";
      for (int i = 0; i < kOnOneBus && (i == 0 || next < motors); ++i, ++next) {
        text += "      - {name: m" + std::to_string(next) + ", profile: wheel, id: " + std::to_string(i + 1) +
                "}\n";
      }
    }
    return text + "modules:\n  - {name: part, type: " + type + ", " + keys + "}\n";
  }
};

inline std::vector<ModuleCase> moduleCases() {
  const std::string corners = "{front_left: m0, front_right: m1, rear_left: m2, rear_right: m3}";
  const std::string steer = "{front_left: m4, front_right: m5, rear_left: m6, rear_right: m7}";
  const std::string sides = ", track_m: 0.5, wheelbase_m: 0.4";
  const std::string motion =
      ", wheel_radius_m: 0.076, max_speed_m_s: 2, max_turn_deg_s: 180, max_acceleration_m_s2: 3, "
      "max_turn_acceleration_deg_s2: 720";
  const std::vector<std::pair<std::string, double>> twist{
      {"vx_m_s", 0.5}, {"vy_m_s", 0.2}, {"wz_deg_s", 30.0}};
  const std::string limits = ", power_limit_w: 80";
  return {
      {"mecanum_chassis", 4, "wheels: " + corners + sides + motion + limits, twist},
      {"omni4_chassis", 4, "wheels: " + corners + sides + motion, twist},
      {"omni3_chassis", 3, "wheels: {left: m0, right: m1, middle: m2}, centre_distance_m: 0.25" + motion,
       twist},
      {"differential_chassis", 2, "wheels: {left: m0, right: m1}, track_m: 0.5" + motion, twist},
      {"swerve_chassis", 8, "drive: " + corners + ", steer: " + steer + sides + motion, twist},
      {"gimbal", 2, "yaw: m0, pitch: m1", {{"yaw_deg", 30.0}, {"pitch_deg", 10.0}}},
      {"feeder", 1, "motor: m0, velocity_limit_rpm: 60", {{"velocity_rpm", 30.0}, {"shots", 0.0}}},
      {"joint",
       1,
       "motor: m0, max_velocity_deg_s: 90, max_acceleration_deg_s2: 300, max_jerk_deg_s3: 2000",
       {{"angle_deg", 360.0}}},
      {"synchronised_pair", 2, "left: m0, right: m1, velocity_limit_rpm: 60", {{"velocity_rpm", 30.0}}},
      // Sticks and switches in the middle.
      {"remote",
       0,
       "port: /dev/rc10-none, protocol: dbus",
       {},
       {0x00, 0x04, 0x20, 0x00, 0x01, 0xF8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x00, 0x04}},
      // Roll, pitch and yaw: 0x53.
      {"imu",
       0,
       "port: /dev/rc10-none, protocol: witmotion",
       {},
       {0x55, 0x53, 0, 0x10, 0, 0x20, 0, 0x30, 0, 0, 0x08}},
      {"gpio", 0, "chip: gpiochip0, outputs: [{name: valve, line: 6}]", {{"valve", 1.0}}},
      {"led_strip", 0, "device: /dev/spidev0.0, pixels: 30", {{"red", 255.0}}},
      // $range,1.5*79 and a line feed.
      {"serial_link",
       0,
       "port: /dev/rc10-none, protocol: text, receive: [{name: range_m, message: range}], send: [{name: "
       "claw, "
       "message: set}]",
       {{"claw", 1.0}},
       {0x24, 0x72, 0x61, 0x6E, 0x67, 0x65, 0x2C, 0x31, 0x2E, 0x35, 0x2A, 0x37, 0x39, 0x0A}},
      {"rangefinder", 0, "port: /dev/rc10-none", {}, {0x59, 0x59, 0x7B, 0, 0x00, 0x02, 0, 0, 0x2F}},
  };
}

}  // namespace rc10::test
