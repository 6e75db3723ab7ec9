#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bus/frame_listener.hpp"
#include "config/client_config.hpp"
#include "config/keys/loop_gains.hpp"
#include "daemon/exchange/shaft_order.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "motor/first_angle.hpp"
#include "motor/motor_family.hpp"
#include "motor/spring_law.hpp"

namespace rc10 {

/// The fixed part of the messages to clients: constant while the daemon runs.
struct RobotDescription {
  std::string robot;
  std::string lcm_url;
  std::string config_hash;  ///< SHA-256 of the configuration file.
  std::string config_file;
  std::optional<ClientsConfig> clients;
  ForbiddenAt tuning_locked_at = 0;
  ForbiddenAt clear_local_at = 0;
  int rate_hz = 1000;
  [[nodiscard]] Duration period() const noexcept { return std::chrono::nanoseconds{1'000'000'000 / rate_hz}; }
  int state_hz = 200;
  struct Motor {
    std::string name;
    std::string model;
    std::size_t bus = 0;
    int id = 0;
    ModeSet modes;
    bool optional = false;              ///< May fail to enable.
    const DriveSetup* setup = nullptr;  ///< Settings that can be written to its drive; null: none.
    MotorLoops loops{};                 ///< As they are at the start.
    std::optional<SimulatedDrive> simulated{};
    SpringRange spring_range{};  ///< Bounds impedance targets, at the output shaft.
    double max_first_step_deg = std::numeric_limits<double>::infinity();
    Travel travel{};
    Duration run_down{};
    const MotorFamily* family = nullptr;
    std::vector<FrameFilter> sends{};   ///< Frames of its drive,
    std::vector<FrameFilter> steers{};  ///< and those that command it.
  };
  struct Bus {
    std::string name;
    std::string interface;
    double bitrate = 1e6;
    float predicted_load = 0.0F;
    float predicted_load_worst = 0.0F;
    double data_bitrate = 0.0;  ///< Data bitrate of CAN FD's data phase; 0: a classic bus.
  };
  struct Module {
    std::string name;
    std::string type;
    ModuleSignals signals;
  };
  std::vector<Motor> motors;
  std::vector<Bus> buses;
  std::vector<Module> modules;
  [[nodiscard]] bool simulated() const noexcept {
    return std::any_of(buses.begin(), buses.end(), [](const Bus& bus) { return bus.interface.empty(); });
  }

  std::vector<std::string> notices;  ///< Deviations from the ideal set-up, each with its remedy.
  bool realtime = true;
  std::string estop_input;     ///< Chip and line; empty: there is none.
  std::string enabling_input;  ///< The same of the enabling switch.
  std::string mode_input;      ///< The same of the mode input.
};

}  // namespace rc10
