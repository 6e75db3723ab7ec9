#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "rc10/lcm_link.hpp"
#include "rc10/module.hpp"
#include "rc10/motor.hpp"
#include "rc10/request.hpp"
#include "rc10/robot_state.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

/// The fate of the motors when a program leaves its robot in good order.
enum class AtEnd : std::uint8_t {
  kTimeout,  ///< Each does its on_timeout, as when the program dies, and stays ACTIVE.
  kDisable,  ///< Those that the program enabled are disabled, and do their on_disable.
  kCoast,    ///< Those that it commanded lose their torque, and those that it enabled are disabled.
};

struct RobotOptions {
  std::string client{};  ///< Name shown as the owner of a motor; empty: the program's.
  int priority = 0;      ///< A client with a higher one takes motors over from a lower one.
  /// Validity of a target, from when rc10d received it: 1 to 1000 ms. A motor goes on for it when the
  /// program has died.
  std::chrono::milliseconds validity{100};
  /// Rate at which held targets are sent again; 0: never, each acts for its validity.
  std::chrono::milliseconds resend{20};
  /// If not 0: held targets are let go of when the program has neither set a target, nor given a module
  /// inputs, nor called alive() for this time. For programs with a loop: one that hangs would otherwise hold
  /// its motors for ever.
  std::chrono::milliseconds alive_within{0};
  AtEnd at_end = AtEnd::kTimeout;  ///< Done by close() and the destructor.
  /// Told what nobody asked about: a target that was dropped, a setpoint that rc10d skipped, messages of
  /// other definitions. The same text at most once a second, on any thread. Without one: stderr.
  std::function<void(const std::string& problem)> on_problem{};
};

/// One robot, seen from one program, through LCM. Every member may be called from any thread; those that wait
/// (wait..., requests) not from a callback.
///
/// **Held targets.** A target is sent at once, and then again every `resend` by a thread that lives as long
/// as this object. So a program that ends or crashes lets go of its motors within `validity`; one that hangs
/// does not, unless `alive_within` is set. A target is dropped, and has to be set anew, when its motor stops
/// being ACTIVE, another client takes it, or no state has come for a second: nothing comes back to life by
/// itself.
///
/// **Leaving.** close() and the destructor end the held targets: each motor does its on_timeout, as when the
/// program dies. RobotOptions::at_end says otherwise. The inputs of modules end in any case.
class Robot {
 public:
  /// `name`: `robot:` in rc10d's configuration. Does not wait for rc10d, and never throws for the state of
  /// the world: status() and whatever is called next say what is wrong.
  explicit Robot(std::string name, RobotOptions options = {});
  Robot(std::string name, const LcmLink& link, RobotOptions options = {});
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  ~Robot();

  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] const LcmLink& link() const noexcept;
  /// Whether this program can command at all: LCM, the names, the numbers in the options.
  [[nodiscard]] Result<void> status() const;

  [[nodiscard]] Motor motor(std::string name) const { return {*session_, std::move(name)}; }
  /// Its outputs are received from now on: ask for it before they are needed.
  [[nodiscard]] Module module(std::string name) const;

  /// Setpoints in one message: they act in the same tick, or none does. Held together.
  Result<void> command(const MotorSetpoints& setpoints) const;
  /// A sign of life: see RobotOptions::alive_within.
  void alive() const;

  /// Waits for a state that is newer than the one known. The error says what to check.
  Result<void> waitForState(Duration timeout = std::chrono::seconds{5}) const;
  /// The newest state; nullptr before the first.
  [[nodiscard]] std::shared_ptr<const RobotState> state() const;

  /// Called with every state, and with every event, on the receiving thread: do not wait in it. Replaces the
  /// callback before. Setting targets in it is fine.
  void onState(std::function<void(const RobotState&)> callback) const;
  void onEvent(std::function<void(const Event&)> callback) const;

  // Requests wait for rc10d's answer; lost ones are repeated under the same number and carried out once.
  // Targets held for motors that a `disable` or `estop` names end before it is sent, whatever the answer.
  /// Until each motor is ACTIVE or has failed, and the state shows it. No names: all motors.
  RequestResult enable(const std::vector<std::string>& motors = {},
                       Duration timeout = std::chrono::seconds{2}) const;
  RequestResult disable(const std::vector<std::string>& motors = {},
                        Duration timeout = std::chrono::seconds{2}) const;
  /// Faults, and without names a latched e-stop. Enables nothing.
  RequestResult clear(const std::vector<std::string>& motors = {},
                      Duration timeout = std::chrono::seconds{2}) const;
  /// Any request: docs/lcm.md. `target`: names with commas; empty: all.
  RequestResult request(const std::string& operation, const std::string& target,
                        const std::map<std::string, double>& values = {},
                        Duration timeout = std::chrono::seconds{2}) const;
  /// Stops the whole robot; latched until clear(). Sent at once and repeated every 20 ms until the state
  /// shows it, after `timeout` as well. In a callback it does not wait.
  Result<void> estop(Duration timeout = std::chrono::seconds{2}) const;

  /// Ends what acts, as RobotOptions::at_end says; half a second at most. The error says what was not
  /// confirmed.
  Result<void> close();

 private:
  std::unique_ptr<RobotSession> session_;
};

}  // namespace robot_client
}  // namespace rc10
