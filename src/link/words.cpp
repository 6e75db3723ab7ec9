#include "link/words.hpp"

#include <array>
#include <span>

#include "app/fault_code.hpp"

namespace rc10::link {
namespace {

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

std::optional<ControlMode> modeOf(std::string_view word) noexcept {
  for (std::size_t i = 0; i < kControlModeWords.size(); ++i) {
    if (word == kControlModeWords[i]) return static_cast<ControlMode>(i);
  }
  return std::nullopt;
}

std::string modeWords(std::uint32_t modes) { return join(kControlModeWords, modes); }
std::string limitWords(std::uint32_t limits) { return join(kLimitWords, limits); }

std::string conditionWords(std::uint32_t conditions) { return join(kConditionWords, conditions); }

std::string stopText(StopCause cause, std::string_view stopped_by) {
  const auto with = [&](const char* words) {
    return stopped_by.empty() ? std::string(words) : words + (" by '" + std::string(stopped_by) + '\'');
  };
  switch (cause) {
    case StopCause::kNone:
      return stopped_by.empty() ? std::string{} : "by '" + std::string(stopped_by) + '\'';
    case StopCause::kRequest: return with("asked for");
    case StopCause::kEstop: return with("e-stop");
    case StopCause::kFault: return "fault";
    case StopCause::kSilence: return "its drive is not heard";
    case StopCause::kGroup: return "its group stopped for '" + std::string(stopped_by) + '\'';
    case StopCause::kTimeout: return "no valid command any more";
    case StopCause::kRefused: return "its drive did not confirm";
    case StopCause::kReference: return "its angle has lost the reference";
    case StopCause::kShutdown: return "rc10d ends";
    case StopCause::kInput: return "the e-stop input";
    case StopCause::kGuard: return "rc10-guard told the drives to rest, has ended, or stands still";
    case StopCause::kOverload: return "the ticks used nearly all of their periods";
  }
  return "unknown cause";
}

std::string faultText(std::int32_t fault) {
  using enum FaultCode;
  switch (FaultCode{fault}) {
    case kNone: return {};
    case kOverspeed: return "over-speed: it turned faster than overspeed_rpm";
    case kOverheated: return "overheated: let it cool down";
    case kStalled: return "stalled: at its limit without turning; see what blocks it";
    case kFollowingError: return "following error: too far from its target for following_error_ms";
    case kEncoderJump:
      return "encoder jump: the angle changed faster than the motor can turn; see its encoder and magnet";
    case kFrozen:
      return "feedback frozen: nothing changes though current is commanded; see the drive and its motor "
             "cable";
    case kRunaway:
      return "runaway: it gains speed against all its torque; see the direction of encoder and phases";
    case kNotAtRest:
      return "not at rest: its drive reports torque though it is told to rest; cut the power, see the bus "
             "and "
             "the drive";
    case kForeignCommands: return "another controller commands its drive; stop one of the two";
    case kReducedSpeed:
      return "too fast for reduced mode: faster than reduced_velocity_rpm allows; see its load, and "
             "reduced_within_ms";
    case kDriveOverVoltage: return "the drive reports over-voltage; see the supply, and what brakes into it";
    case kDriveUnderVoltage: return "the drive reports under-voltage; see battery and power cable";
    case kDriveOverCurrent: return "the drive reports over-current";
    case kDriveTooHot: return "the drive reports that it is too hot";
    case kDriveMotorTooHot: return "the drive reports that its motor is too hot";
    case kDriveOverload: return "the drive reports an overload";
    case kDriveEncoder: return "the drive reports an encoder error; see its cable and magnet";
    case kDriveCommunication: return "the drive's watchdog: too long without a command; see the bus";
    case kDriveCalibration: return "the drive is not calibrated, or its calibration has failed";
    case kDrivePhase: return "the drive reports a phase or hall sensor error; see the motor cable";
    case kDriveHardware: return "the drive reports a hardware error";
    case kDriveSetting: return "the drive cannot follow a setting or command; see its own configuration";
    case kDriveStalled: return "the drive reports a stall; see what blocks it";
    case kDriveLimit: return "the drive has met one of its own limits of speed or position";
    case kDriveStopped:
      return "the drive is not enabled any more: it was restarted, or another program told it so";
    case kDriveOther: return "the drive reports an error of its own";
    default: return "fault " + std::to_string(fault);
  }
}

}  // namespace rc10::link
