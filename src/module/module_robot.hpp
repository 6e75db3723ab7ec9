#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "app/target.hpp"
#include "app/time.hpp"
#include "module/robot_status.hpp"
#include "motor/motor_base.hpp"

namespace rc10 {

/// An input or an output of a module.
struct SignalPlace {
  std::size_t module = 0;
  std::size_t signal = 0;
};

/// Robot, as a module reads and commands it. Motors are indices in the robot's list, as a key of kind kMotor
/// gives them. Scheduler thread only.
class ModuleRobot {
 public:
  ModuleRobot() = default;
  ModuleRobot(const ModuleRobot&) = delete;
  ModuleRobot& operator=(const ModuleRobot&) = delete;
  virtual ~ModuleRobot() = default;

  [[nodiscard]] virtual RobotStatus state() const noexcept = 0;
  [[nodiscard]] virtual std::size_t motorCount() const noexcept = 0;
  /// At the output shaft; its age is tick.now - feedback.received.
  [[nodiscard]] virtual const MotorFeedback& feedback(std::size_t motor) const noexcept = 0;
  [[nodiscard]] virtual MotorStatus status(std::size_t motor) const noexcept = 0;
  /// Whether a target of this module would be obeyed now: the motor is ACTIVE, nobody else commands it, and
  /// the module's inputs are not from before it was enabled.
  [[nodiscard]] virtual bool obeys(std::size_t motor) const noexcept = 0;
  /// Requests to disable a motor since the start, of clients and modules, one for each motor that they name;
  /// of those that nobody asked for, only those that ended an enabling. Who enables by itself stops at the
  /// next.
  [[nodiscard]] virtual std::uint32_t disables() const noexcept = 0;
  /// Highest speed that the reduced mode leaves the motor now, rpm; infinite where it leaves it all. Each
  /// motor is held to its own: who divides a motion among several keeps below the lowest.
  [[nodiscard]] virtual double speedCeilingRpm(std::size_t motor) const noexcept = 0;

  /// For this tick. All targets of one update() act together, or, if one of the motors is commanded by
  /// somebody of the same or a higher priority, none does. A motor without a target for some ticks falls
  /// back as configured by on_timeout.
  virtual void setTarget(std::size_t motor, const Target& target) noexcept = 0;
  /// A request, as a person would make it, with all its rules; the outcome is seen in status(). For kZero
  /// `angle_deg` is what the present angle becomes; a module may zero a motor that is ACTIVE, as long as no
  /// target in force refers to the angle.
  virtual void ask(RobotRequest request, std::size_t motor, double angle_deg = 0.0) noexcept = 0;
  /// The same for several in one request, as motors that are enabled together need it.
  virtual void ask(RobotRequest request, std::span<const std::size_t> motors) noexcept = 0;
  /// The same for all motors. kEstop and the clearing of an e-stop are always for all.
  virtual void askAll(RobotRequest request) noexcept = 0;
  /// Before a motor is homed: from this tick on its angle has no reference, so that its soft limits do not
  /// act, until it is zeroed. To be called only with a target in the same update() that follows no angle.
  virtual void forgetReference(std::size_t motor) noexcept = 0;

  /// Since a client was last heard: by a command, a request or inputs of a module, or by hearClient().
  [[nodiscard]] virtual double clientsSilentSeconds() const noexcept = 0;
  /// A person speaks through this module, as by a remote, and has last done so at `said`: that counts as a
  /// client. In each tick in which it is so, before what follows from it.
  virtual void hearClient(MonotonicTime said) noexcept = 0;

  /// An output of another module, as its last update() left it. NaN: without meaning now.
  [[nodiscard]] virtual double read(SignalPlace output) const noexcept = 0;
  /// Gives another module an input, as a client with this module's name and priority, for some ticks. All of
  /// one update() that go to one module are one message.
  virtual void send(SignalPlace input, double value) noexcept = 0;
  /// Reports an event: its place in ModuleSignals::events. Once for each happening, not in every tick.
  virtual void report(std::size_t event) noexcept = 0;
};

}  // namespace rc10
