#pragma once

#include <chrono>
#include <future>
#include <map>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/units.hpp"
#include "rc10/move.hpp"
#include "rc10/request.hpp"
#include "rc10/robot_state.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

class RobotSession;

/// One motor of a Robot, by its name in the configuration: a handle, cheap to copy, valid as long as its
/// Robot. Every member may be called from any thread; angles, velocities and torques are at the output shaft.
///
/// A target is sent at once and then held (Robot). The result says why it was not sent; whether the
/// motor obeys shows in state(): mode, target, owner.
class Motor {
 public:
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  Result<void> setTarget(const Setpoint& setpoint) const;
  Result<void> setTargetCurrent(Amperes current) const { return setTarget(Setpoint::current(current)); }
  Result<void> setTargetRPM(Rpm velocity, FeedForward forward = {}) const {
    return setTarget(Setpoint::velocity(velocity, forward));
  }
  /// The shortest way round.
  Result<void> setTargetAngle(Degrees angle, FeedForward forward = {}) const {
    return setTarget(Setpoint::angle(angle, forward));
  }
  /// Multi-turn.
  Result<void> setTargetTotalAngle(Degrees angle, FeedForward forward = {}) const {
    return setTarget(Setpoint::totalAngle(angle, forward));
  }
  Result<void> setTargetImpedance(Degrees angle, double stiffness_nm_per_rad, double damping_nms_per_rad,
                                  FeedForward forward = {}) const {
    return setTarget(Setpoint::impedance(angle, stiffness_nm_per_rad, damping_nms_per_rad, forward));
  }
  Result<void> setTargetVoltage(Volts voltage) const { return setTarget(Setpoint::voltage(voltage)); }
  /// -1 to 1.
  Result<void> setTargetDuty(double duty) const { return setTarget(Setpoint::duty(duty)); }
  Result<void> brake() const { return setTarget(Setpoint::brake()); }
  /// No torque, and nothing is held any more.
  Result<void> coast() const { return setTarget(Setpoint::coast()); }

  /// Goes to a multi-turn angle. The future has its value when the motor has stood within `tolerance` for
  /// 60 ms, when it cannot get there, after `timeout`, or when another target is set or the Robot is closed.
  /// Waiting for it in a callback would wait for ever.
  [[nodiscard]] std::future<MoveResult> moveTo(Degrees total_angle, Degrees tolerance = Degrees{1.0},
                                               Duration timeout = std::chrono::seconds{5}) const;
  /// The same for an angle on the circle, the shortest way round.
  [[nodiscard]] std::future<MoveResult> moveToAngle(Degrees angle, Degrees tolerance = Degrees{1.0},
                                                    Duration timeout = std::chrono::seconds{5}) const;

  /// State of the newest state; before the first: OFFLINE, and NaN in all readings.
  [[nodiscard]] MotorState state() const;

  // Requests: as in Robot, for this motor.
  RequestResult enable(Duration timeout = std::chrono::seconds{2}) const;
  RequestResult disable(Duration timeout = std::chrono::seconds{2}) const;
  RequestResult clear(Duration timeout = std::chrono::seconds{2}) const;
  /// The present angle becomes `angle`; not while the motor is ACTIVE.
  RequestResult zero(Degrees angle = {}, Duration timeout = std::chrono::seconds{2}) const;
  /// The gains in force of the loops that rc10d closes for it: `values`, by the keys of the configuration
  /// ("velocity_pid.kp_a_per_rpm"). `message` has the lines for the robot's file. Refused if its drive closes
  /// its loops.
  RequestResult gains(Duration timeout = std::chrono::seconds{2}) const;
  /// Changes gains, also while the motor is ACTIVE, without a bump: all of them or none. By those keys, or in
  /// brief ("velocity.kp"). `values`: all after that; `message`: before and after. A restart of rc10d forgets
  /// them.
  RequestResult setGains(const std::map<std::string, double>& gains,
                         Duration timeout = std::chrono::seconds{2}) const;

 private:
  friend class Robot;
  Motor(RobotSession& session, std::string name) : session_(&session), name_(std::move(name)) {}

  RobotSession* session_;
  std::string name_;
};

}  // namespace robot_client
}  // namespace rc10
