#include "link/words.hpp"

#include <array>
#include <span>

namespace rc10::link {
namespace {

constexpr std::array kMotorStatuses{"OFFLINE", "READY", "ENABLING", "ACTIVE", "FAULT"};
constexpr std::array kRobotStates{"RUN", "ESTOP", "STOPPING"};
constexpr std::array kBusStates{"active", "warning", "passive", "bus-off",
                                "down",   "gone",    "silent",  "stalled"};
constexpr std::array kSeverities{"info", "warning", "error"};
constexpr std::array kModes{"coast",     "current", "velocity", "angle", "total_angle",
                            "impedance", "voltage", "duty",     "brake"};
constexpr std::array kModeUnits{"", "A", "rpm", "deg", "deg", "deg", "V", "", ""};
constexpr std::array kCommandUnits{"", "A", "V", "native"};
constexpr std::array kLimits{"current", "velocity", "angle", "temperature", "slew", "stall"};
constexpr std::array kGains{"velocity_pid.kp_a_per_rpm",
                            "velocity_pid.ki_a_per_rpm_s",
                            "velocity_pid.kd_a_s_per_rpm",
                            "velocity_pid.deadband_rpm",
                            "velocity_pid.derivative_filter_hz",
                            "velocity_pid.integral_limit_a",
                            "velocity_pid.integral_separation_rpm",
                            "velocity_pid.target_bandwidth_rad_s",
                            "angle_pid.kp_rpm_per_deg",
                            "angle_pid.ki_rpm_per_deg_s",
                            "angle_pid.kd_rpm_s_per_deg",
                            "angle_pid.deadband_deg",
                            "angle_pid.velocity_limit_rpm",
                            "angle_pid.integral_limit_rpm",
                            "angle_pid.integral_separation_deg",
                            "angle_pid.derivative_filter_hz"};
constexpr std::int32_t kInVolts = 256;
static_assert(kModes.size() == kModeCount && kModeUnits.size() == kModeCount);

const char* pick(std::span<const char* const> words, std::size_t index, const char* otherwise) noexcept {
  return index < words.size() ? words[index] : otherwise;
}

std::string join(std::span<const char* const> words, std::uint32_t bits) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if ((bits & (1U << i)) == 0) continue;
    if (!text.empty()) text += ',';
    text += words[i];
  }
  return text;
}

}  // namespace

const char* motorStatusWord(std::uint8_t status) noexcept { return pick(kMotorStatuses, status, "UNKNOWN"); }
const char* robotStateWord(std::uint8_t state) noexcept { return pick(kRobotStates, state, "UNKNOWN"); }
const char* busStateWord(std::uint8_t state) noexcept { return pick(kBusStates, state, "unknown"); }
const char* severityWord(std::uint8_t severity) noexcept { return pick(kSeverities, severity, "unknown"); }
const char* modeWord(std::uint8_t mode) noexcept { return pick(kModes, mode, "unknown"); }
const char* modeUnit(std::uint8_t mode) noexcept { return pick(kModeUnits, mode, ""); }
const char* commandUnitWord(std::uint8_t unit) noexcept { return pick(kCommandUnits, unit, "unknown"); }

const char* gainWord(std::int32_t gain) noexcept {
  switch (gain) {
    case kInVolts + 0: return "velocity_pid.kp_v_per_rpm";
    case kInVolts + 1: return "velocity_pid.ki_v_per_rpm_s";
    case kInVolts + 2: return "velocity_pid.kd_v_s_per_rpm";
    case kInVolts + 5: return "velocity_pid.integral_limit_v";
    default: break;
  }
  const auto index = static_cast<std::size_t>(gain < kInVolts ? gain : gain - kInVolts);
  return gain >= 0 ? pick(kGains, index, "unknown gain") : "unknown gain";
}

std::optional<std::uint8_t> modeOf(std::string_view word) noexcept {
  for (std::size_t i = 0; i < kModes.size(); ++i) {
    if (word == kModes[i]) return static_cast<std::uint8_t>(i);
  }
  return std::nullopt;
}

std::string modeWords(std::uint32_t modes) { return join(kModes, modes); }
std::string limitWords(std::uint32_t limits) { return join(kLimits, limits); }

std::string faultText(std::int32_t fault) {
  switch (fault) {
    case 0: return {};
    case 1: return "over-speed: it turned faster than overspeed_rpm";
    case 2: return "overheated: let it cool down";
    case 3: return "stalled: at its limit without turning; see what blocks it";
    case 4: return "following error: too far from its target for following_error_ms";
    case 5:
      return "encoder jump: the angle changed faster than the motor can turn; see its encoder and magnet";
    case 6:
      return "feedback frozen: nothing changes though current is commanded; see the drive and its motor "
             "cable";
    case 7: return "runaway: it gains speed against all its torque; see the direction of encoder and phases";
    case 32: return "the drive reports over-voltage; see the supply, and what brakes into it";
    case 33: return "the drive reports under-voltage; see battery and power cable";
    case 34: return "the drive reports over-current";
    case 35: return "the drive reports that it is too hot";
    case 36: return "the drive reports that its motor is too hot";
    case 37: return "the drive reports an overload";
    case 38: return "the drive reports an encoder error; see its cable and magnet";
    case 39: return "the drive's watchdog: too long without a command; see the bus";
    case 40: return "the drive is not calibrated, or its calibration has failed";
    case 41: return "the drive reports a phase or hall sensor error; see the motor cable";
    case 42: return "the drive reports a hardware error";
    case 43: return "the drive cannot follow a setting or command; see its own configuration";
    case 44: return "the drive reports a stall; see what blocks it";
    case 45: return "the drive has met one of its own limits of speed or position";
    case 46: return "the drive is not enabled any more: it was restarted, or another program told it so";
    case 47: return "the drive reports an error of its own";
    default: return "fault " + std::to_string(fault);
  }
}

}  // namespace rc10::link
