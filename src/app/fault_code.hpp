#pragma once

#include <cstdint>

namespace rc10 {

/// Reason why a motor is in FAULT. The numbers are part of the LCM contract (motor_state_t.fault,
/// docs/lcm.md) and never change; link::faultText() has the words.
enum class FaultCode : std::int32_t {
  kNone = 0,
  // Found by rc10d.
  kOverspeed = 1,
  kOverheated = 2,
  kStalled = 3,
  kFollowingError = 4,
  kEncoderJump = 5,
  kFrozen = 6,
  kRunaway = 7,
  kNotAtRest = 8,        ///< Its drive has torque though it is told to rest.
  kForeignCommands = 9,  ///< Somebody else commands its drive.
  kReducedSpeed = 10,    ///< Faster than reduced_velocity_rpm while the mode input is open.
  // Reported by the drive: every family maps its own codes to these.
  kDriveOverVoltage = 32,
  kDriveUnderVoltage = 33,
  kDriveOverCurrent = 34,
  kDriveTooHot = 35,       ///< The power stage.
  kDriveMotorTooHot = 36,  ///< The winding, as the drive measures it.
  kDriveOverload = 37,
  kDriveEncoder = 38,
  kDriveCommunication = 39,  ///< Its watchdog: too long without a command.
  kDriveCalibration = 40,
  kDrivePhase = 41,     ///< A motor cable, a hall sensor.
  kDriveHardware = 42,  ///< Gate driver, current sensor, supply of the electronics.
  kDriveSetting = 43,   ///< A setting or command that it cannot follow.
  kDriveStalled = 44,
  kDriveLimit = 45,  ///< One of its own limits of speed or position.
  kDriveStopped =
      46,  ///< Not enabled any more, though nobody asked: it was restarted, or told so by another.
  kDriveOther = 47,
};

}  // namespace rc10
