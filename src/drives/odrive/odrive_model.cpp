#include "drives/odrive/odrive_model.hpp"

#include <array>

#include "motor/model_table.hpp"

namespace rc10 {
namespace {

// Peak currents: S1 and Pro as their data sheets give them; v3 the range that its firmware measures by
// default (requested_current_range in Firmware/MotorControl/motor.hpp): a higher limit would only trip it.
constexpr std::array<OdriveModel, 3> kOdriveModels{
    OdriveModel{"ODrive_S1", OdriveFirmware::k06, 80.0F},
    OdriveModel{"ODrive_Pro", OdriveFirmware::k06, 120.0F},
    OdriveModel{"ODrive_v3", OdriveFirmware::k05, 60.0F},
};
constexpr auto kOdriveNames = modelNames(kOdriveModels);

constexpr std::uint32_t kMotorFailed = 0x40;
constexpr std::uint32_t kEncoderFailed = 0x100;
constexpr std::uint32_t kControllerFailed = 0x200;

// ODrive.Axis.Error of odriverobotics/ODrive@f9b5419c:Firmware/odrive-interface.yaml. The causes (watchdog,
// e-stop, end stops) come before the parts that failed.
constexpr auto kOdriveFaults05 = [] {
  using enum FaultCode;
  return std::array{
      DriveFault{0x800, kDriveCommunication, "watchdog expired: too long without a frame"},
      DriveFault{0x4000, kDriveStopped, "e-stop asked for over CAN"},
      DriveFault{0x1000, kDriveLimit, "the lower end stop is pressed"},
      DriveFault{0x2000, kDriveLimit, "the upper end stop is pressed"},
      DriveFault{0x40000, kDriveTooHot, "too hot"},
      DriveFault{kEncoderFailed, kDriveEncoder, "encoder failed: read encoder.error"},
      DriveFault{0x80000, kDriveEncoder, "position unknown"},
      DriveFault{0x80, kDriveEncoder, "sensorless estimate failed"},
      DriveFault{kMotorFailed, kDriveHardware, "motor failed: read motor.error"},
      DriveFault{kControllerFailed, kDriveLimit,
                 "controller failed, most often over-speed: read controller.error"},
      DriveFault{0x20000, kDriveSetting, "homing without an end stop"},
      DriveFault{0x1, kDriveCalibration, "cannot enter that state: not calibrated"},
  };
}();

// ODrive.Error of odriverobotics/ros_odrive:odrive_base/include/odrive_enums.h.
constexpr std::uint32_t kInitializing = 0x1;
constexpr auto kOdriveFaults06 = [] {
  using enum FaultCode;
  return std::array{
      DriveFault{0x0100'0000, kDriveCommunication, "watchdog expired: too long without a frame"},
      DriveFault{0x0200'0000, kDriveStopped, "e-stop asked for"},
      DriveFault{0x100, kDriveOverVoltage, "supply voltage too high"},
      DriveFault{0x200, kDriveUnderVoltage, "supply voltage too low"},
      DriveFault{0x400, kDriveOverCurrent, "supply current too high"},
      DriveFault{0x800, kDriveOverCurrent, "too much current back into the supply"},
      DriveFault{0x1000, kDriveOverCurrent, "motor current beyond its limit"},
      DriveFault{0x2000, kDriveMotorTooHot, "motor too hot"},
      DriveFault{0x4000, kDriveTooHot, "power stage too hot"},
      DriveFault{0x8000, kDriveLimit, "faster than its velocity limit"},
      DriveFault{0x1'0000, kDriveLimit, "beyond its position limit"},
      DriveFault{0x2'0000, kDriveSetting, "more current asked for than its limit"},
      DriveFault{0x0400'0000, kDriveEncoder, "spin-out: encoder and motor do not agree"},
      DriveFault{0x8, kDriveEncoder, "no position estimate"},
      DriveFault{0x4000'0000, kDriveCalibration, "calibration failed"},
      DriveFault{0x1000'0000, kDriveHardware, "thermistor not connected"},
      DriveFault{0x0800'0000, kDriveHardware, "brake resistor not armed"},
      DriveFault{0x20, kDriveHardware, "gate driver fault"},
      DriveFault{0x10, kDriveSetting, "configuration not valid"},
      DriveFault{0x40, kDriveSetting, "an input is missing"},
      DriveFault{0x4, kDriveOther, "its control loop was too late"},
      DriveFault{0x2, kDriveOther, "system error"},
  };
}();

}  // namespace

std::span<const std::string_view> odriveModelNames() noexcept { return kOdriveNames; }

const OdriveModel* findOdriveModel(std::string_view name) noexcept { return findModel(kOdriveModels, name); }

std::span<const DriveFault> odriveFaults(OdriveFirmware firmware) noexcept {
  if (firmware == OdriveFirmware::k05) return kOdriveFaults05;
  return kOdriveFaults06;
}

std::uint32_t odriveErrors(OdriveFirmware firmware, const odrive::Heartbeat& heartbeat) noexcept {
  // Every 0.6 drive begins with this bit; it is over after a moment, and no fault.
  if (firmware == OdriveFirmware::k06) return heartbeat.axis_error & ~kInitializing;
  // An idle 0.5 axis may report a failed part in its flags alone.
  return heartbeat.axis_error | ((heartbeat.byte5 & 1U) != 0 ? kMotorFailed : 0U) |
         ((heartbeat.byte6 & 1U) != 0 ? kEncoderFailed : 0U) |
         ((heartbeat.byte7 & 1U) != 0 ? kControllerFailed : 0U);
}

bool odriveStarting(OdriveFirmware firmware, const odrive::Heartbeat& heartbeat) noexcept {
  if (heartbeat.state == odrive::AxisState::kUndefined) return true;
  return firmware == OdriveFirmware::k06 && (heartbeat.axis_error & kInitializing) != 0;
}

}  // namespace rc10
