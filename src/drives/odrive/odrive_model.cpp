#include "drives/odrive/odrive_model.hpp"

#include <algorithm>
#include <array>

namespace rc10 {
namespace {

// Peak currents: S1 and Pro as their data sheets give them; v3 the range that its firmware measures by
// default (requested_current_range in Firmware/MotorControl/motor.hpp): a higher limit would only trip it.
constexpr std::array<OdriveModel, 3> kOdriveModels{
    OdriveModel{"ODrive_S1", OdriveFirmware::k06, 80.0F},
    OdriveModel{"ODrive_Pro", OdriveFirmware::k06, 120.0F},
    OdriveModel{"ODrive_v3", OdriveFirmware::k05, 60.0F},
};

constexpr std::uint32_t kMotorFailed = 0x40;
constexpr std::uint32_t kEncoderFailed = 0x100;
constexpr std::uint32_t kControllerFailed = 0x200;

// ODrive.Axis.Error of odriverobotics/ODrive@f9b5419c:Firmware/odrive-interface.yaml. The causes (watchdog,
// e-stop, end stops) come before the parts that failed.
constexpr auto kOdriveFaults05 = [] {
  using enum FaultCode;
  return std::array{
      OdriveFault{0x800, kDriveCommunication, "watchdog expired: too long without a frame"},
      OdriveFault{0x4000, kDriveStopped, "e-stop asked for over CAN"},
      OdriveFault{0x1000, kDriveLimit, "the lower end stop is pressed"},
      OdriveFault{0x2000, kDriveLimit, "the upper end stop is pressed"},
      OdriveFault{0x40000, kDriveTooHot, "too hot"},
      OdriveFault{kEncoderFailed, kDriveEncoder, "encoder failed: read encoder.error"},
      OdriveFault{0x80000, kDriveEncoder, "position unknown"},
      OdriveFault{0x80, kDriveEncoder, "sensorless estimate failed"},
      OdriveFault{kMotorFailed, kDriveHardware, "motor failed: read motor.error"},
      OdriveFault{kControllerFailed, kDriveLimit,
                  "controller failed, most often over-speed: read controller.error"},
      OdriveFault{0x20000, kDriveSetting, "homing without an end stop"},
      OdriveFault{0x1, kDriveCalibration, "cannot enter that state: not calibrated"},
  };
}();

// ODrive.Error of odriverobotics/ros_odrive:odrive_base/include/odrive_enums.h.
constexpr std::uint32_t kInitializing = 0x1;
constexpr auto kOdriveFaults06 = [] {
  using enum FaultCode;
  return std::array{
      OdriveFault{0x0100'0000, kDriveCommunication, "watchdog expired: too long without a frame"},
      OdriveFault{0x0200'0000, kDriveStopped, "e-stop asked for"},
      OdriveFault{0x100, kDriveOverVoltage, "supply voltage too high"},
      OdriveFault{0x200, kDriveUnderVoltage, "supply voltage too low"},
      OdriveFault{0x400, kDriveOverCurrent, "supply current too high"},
      OdriveFault{0x800, kDriveOverCurrent, "too much current back into the supply"},
      OdriveFault{0x1000, kDriveOverCurrent, "motor current beyond its limit"},
      OdriveFault{0x2000, kDriveMotorTooHot, "motor too hot"},
      OdriveFault{0x4000, kDriveTooHot, "power stage too hot"},
      OdriveFault{0x8000, kDriveLimit, "faster than its velocity limit"},
      OdriveFault{0x1'0000, kDriveLimit, "beyond its position limit"},
      OdriveFault{0x0400'0000, kDriveEncoder, "spin-out: encoder and motor do not agree"},
      OdriveFault{0x8, kDriveEncoder, "no position estimate"},
      OdriveFault{0x4000'0000, kDriveCalibration, "calibration failed"},
      OdriveFault{0x1000'0000, kDriveHardware, "thermistor not connected"},
      OdriveFault{0x0800'0000, kDriveHardware, "brake resistor not armed"},
      OdriveFault{0x20, kDriveHardware, "gate driver fault"},
      OdriveFault{0x10, kDriveSetting, "configuration not valid"},
      OdriveFault{0x40, kDriveSetting, "an input is missing"},
      OdriveFault{0x4, kDriveOther, "its control loop was too late"},
      OdriveFault{0x2, kDriveOther, "system error"},
  };
}();

}  // namespace

std::span<const OdriveModel> odriveModels() noexcept { return kOdriveModels; }

const OdriveModel* findOdriveModel(std::string_view name) noexcept {
  const auto* found = std::find_if(kOdriveModels.begin(), kOdriveModels.end(),
                                   [&](const auto& model) { return model.name == name; });
  return found == kOdriveModels.end() ? nullptr : found;
}

std::span<const OdriveFault> odriveFaults(OdriveFirmware firmware) noexcept {
  if (firmware == OdriveFirmware::k05) return kOdriveFaults05;
  return kOdriveFaults06;
}

std::uint32_t odriveErrors(OdriveFirmware firmware, const OdriveHeartbeat& heartbeat) noexcept {
  // Every 0.6 drive begins with this bit; it is over after a moment, and no fault.
  if (firmware == OdriveFirmware::k06) return heartbeat.axis_error & ~kInitializing;
  // An idle 0.5 axis may report a failed part in its flags alone.
  return heartbeat.axis_error | ((heartbeat.byte5 & 1U) != 0 ? kMotorFailed : 0U) |
         ((heartbeat.byte6 & 1U) != 0 ? kEncoderFailed : 0U) |
         ((heartbeat.byte7 & 1U) != 0 ? kControllerFailed : 0U);
}

DriveComplaint odriveComplaint(OdriveFirmware firmware, std::uint32_t errors) noexcept {
  if (errors == 0) return {};
  for (const auto& row : odriveFaults(firmware)) {
    if ((errors & row.bit) != 0) return {.fault = row.fault, .native_code = errors};
  }
  return {.fault = FaultCode::kDriveOther, .native_code = errors};
}

bool odriveStarting(OdriveFirmware firmware, const OdriveHeartbeat& heartbeat) noexcept {
  if (heartbeat.state == OdriveAxisState::kUndefined) return true;
  return firmware == OdriveFirmware::k06 && (heartbeat.axis_error & kInitializing) != 0;
}

}  // namespace rc10
