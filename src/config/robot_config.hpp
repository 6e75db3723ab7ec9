#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "bus/can_link_settings.hpp"
#include "config/client_config.hpp"
#include "config/gpio_config.hpp"
#include "module/module_type.hpp"
#include "motor/guarding/fallback.hpp"
#include "motor/guarding/motor_guard.hpp"
#include "motor/guarding/reduced_motion.hpp"
#include "motor/guarding/rest_check.hpp"
#include "motor/guarding/target_shaper.hpp"
#include "motor/motor_family.hpp"
#include "sim/load_change.hpp"
#include "sim/sim_config.hpp"

namespace rc10 {

/// Where something stands in the configuration file. Lines and columns count from 1.
struct SourcePlace {
  int line = 0;
  int column = 0;
};

struct MotorConfig {
  SourcePlace place;
  const MotorFamily* family = nullptr;
  MotorSettings settings;
  Duration feedback_timeout{std::chrono::milliseconds{20}};
  GuardConfig guard{};
  RestConfig rest{};
  ShapingConfig shaping{};
  ReducedConfig reduced{};
  FallbackConfig fallback{};
  float standstill_rpm = 10.0F;                ///< Slower than this it stands still.
  Duration run_down{std::chrono::seconds{5}};  ///< Without torque it turns no longer than this.
  bool optional = false;
  sim::MotorLoad simulated;         ///< Used on a simulated bus and by rc10-sim.
  sim::LoadPlan load_plan;          ///< The same.
  std::optional<int> simulated_id;  ///< Id of the simulated drive; none: settings.id.

  [[nodiscard]] MotorTraits traits() const { return family->traits(settings.model, settings.own); }
  [[nodiscard]] const std::string& name() const noexcept { return settings.name; }
};

/// Frames of others that command our drives, for the motors of one bus.
struct ForeignLimit {
  static constexpr int kMost = 16;
  int frames = 3;  ///< This number within the time is a fault; 0: they are only told.
  Duration within{std::chrono::milliseconds{100}};
};

enum class BusType : std::uint8_t { kSocketCan, kSimulated };

struct BusConfig {
  SourcePlace place;
  std::string name;
  BusType type = BusType::kSocketCan;
  std::string interface;  ///< SocketCAN only.
  int bitrate = 1'000'000;
  int data_bitrate = 0;       ///< Data bitrate of the data phase of CAN FD frames; 0: a classic bus.
  double sample_point = 0.0;  ///< Share of the bit, 0 to 1; 0: what the kernel chooses.
  double data_sample_point = 0.0;
  bool manage_link = false;  ///< rc10d sets the bit rate and takes the interface down and up.
  ForeignLimit foreign{};
  Duration stalled_after{
      std::chrono::milliseconds{5}};  ///< Without an echo of its own frames. SocketCAN only.
  std::uint64_t sim_seed = 1;         ///< Simulated buses and rc10-sim.
  std::vector<MotorConfig> motors;

  [[nodiscard]] CanLinkSettings linkSettings() const noexcept {
    return {.bitrate = bitrate,
            .data_bitrate = data_bitrate,
            .sample_point = sample_point,
            .data_sample_point = data_sample_point};
  }
};

/// Motors that stop together. An optional one stops with the others, and nothing stops or waits for it.
struct GroupConfig {
  enum class Return : std::uint8_t {
    kRequest,      ///< Each member must be enabled again.
    kRearmAtRest,  ///< Enabled again by itself once every member is there and stands still.
  };
  SourcePlace place;
  std::string name;
  std::vector<std::size_t> motors;  ///< Their places among all motors of the robot, in the file's order.
  Return on_return = Return::kRequest;
  bool together = false;  ///< Enabled together, too, and obeying only when all do.
  bool implied = false;   ///< By the module of its name.
};

/// A chassis, a gimbal, a remote: see module_base.hpp.
struct ModuleConfig {
  SourcePlace place;
  std::string path;  ///< "modules[2]"
  const ModuleType* type = nullptr;
  ModuleSettings settings;
};

enum class RealtimePolicy : std::uint8_t { kRequired, kPreferred };
/// Settings of rc10-guard.
enum class GuardPolicy : std::uint8_t { kRequired, kPreferred, kOff };

/// Extent of the stop when a drive does not rest.
enum class UnrestPolicy : std::uint8_t {
  kGroup,      ///< Its group.
  kEstop,      ///< The robot.
  kHeartbeat,  ///< The robot, and the heartbeat, so that a relay cuts the power.
};

/// Settings of the scheduler's thread.
enum class TimerPolicy : std::uint8_t { kAuto, kTimerfd, kNanosleep };
/// Clock of whose periods RobotConfig::phase_of_period is a part.
enum class PhaseClock : std::uint8_t { kMonotonic, kRealtime };
/// The reader of the CAN sockets.
enum class ReceivePolicy : std::uint8_t { kTick, kThread };

struct ThreadConfig {
  int priority = 0;        ///< SCHED_FIFO
  std::optional<int> cpu;  ///< Pinned to this CPU.
};

struct LcmConfig {
  bool enabled = true;
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  int state_hz = 200;
  bool leaves_computer = false;  ///< The url has a ttl above 0.
};

struct RobotConfig {
  std::string file;
  std::string hash;  ///< SHA-256 of the file, as sha256sum prints it.
  std::string robot;
  RealtimePolicy realtime = RealtimePolicy::kRequired;
  GuardPolicy guard = GuardPolicy::kPreferred;
  UnrestPolicy unrest = UnrestPolicy::kGroup;
  ReceivePolicy receive = ReceivePolicy::kTick;
  int rate_hz = 1000;
  TimerPolicy timer = TimerPolicy::kAuto;
  double phase_of_period = 0.3;  ///< 0 to below 1: place of the ticks in a period of `phase_clock`.
  PhaseClock phase_clock = PhaseClock::kMonotonic;
  /// CPU time of ticks that overrun, until the robot stops.
  Duration overload = std::chrono::milliseconds{100};
  ThreadConfig scheduler{.priority = 60, .cpu = std::nullopt};
  ThreadConfig rx{.priority = 65, .cpu = std::nullopt};
  Duration rx_lead = std::chrono::microseconds{100};  ///< Before the tick, with ReceivePolicy::kThread.
  LcmConfig lcm;
  std::optional<ClientsConfig> clients;  ///< None: everybody may do everything.
  ForbiddenAt tuning_locked_at = 0;      ///< Line of `tuning: locked`.
  ForbiddenAt clear_local_at = 0;        ///< Line of `clear: local`.
  std::optional<ContactGpioConfig> estop_gpio;
  std::optional<ContactGpioConfig> enabling_gpio;  ///< Contact of a three-position enabling switch.
  std::optional<ContactGpioConfig> mode_gpio;      ///< Closed: full speed; open: reduced.
  std::optional<HeartbeatGpioConfig> heartbeat_gpio;
  int blackbox_mib = 16;  ///< 0: none.
  std::vector<BusConfig> buses;
  std::vector<GroupConfig> groups;
  std::vector<ModuleConfig> modules;

  [[nodiscard]] Duration period() const noexcept { return std::chrono::nanoseconds{1'000'000'000 / rate_hz}; }
  /// Phase of the ticks' grid, after multiples of period() on `phase_clock`.
  [[nodiscard]] Duration phase() const noexcept {
    return Duration{static_cast<Duration::rep>(phase_of_period * static_cast<double>(period().count()))};
  }
  /// Whether rc10-guard is to run: drives on SocketCAN may keep their last command when rc10d dies.
  [[nodiscard]] bool wantsGuard() const noexcept {
    return guard != GuardPolicy::kOff && std::any_of(buses.begin(), buses.end(), [](const BusConfig& bus) {
             return bus.type == BusType::kSocketCan && !bus.motors.empty();
           });
  }
};

}  // namespace rc10
