#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/result.hpp"
#include "app/time.hpp"
#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {

class RobotSession;

/// Values by name, with their units in the names: {{"vx_m_s", 0.5}, {"wz_deg_s", 30}}.
using Signals = std::map<std::string, double, std::less<>>;

/// Options of inputs.
struct SendOptions {
  /// Validity, from when rc10d receives them: 1 to 1000 ms; 0: its default, 50.
  std::chrono::milliseconds validity{0};
  /// Against other clients of the module; without one: that of the Robot.
  std::optional<int> priority{};
};

/// The outputs of a module; NaN is what means nothing now.
struct ModuleState {
  Signals outputs{};
  std::string owner{};       ///< The client that gives its inputs; empty: nobody.
  MonotonicTime received{};  ///< When they came, by this computer's clock.

  /// Whether they ever came.
  [[nodiscard]] explicit operator bool() const noexcept { return !outputs.empty(); }
  /// Very large before the first.
  [[nodiscard]] Duration age() const noexcept { return std::chrono::steady_clock::now() - received; }
  /// The output `name`; NaN: the module has none of this name, or nothing has come yet.
  [[nodiscard]] double operator[](std::string_view name) const noexcept {
    const auto found = outputs.find(name);
    return found == outputs.end() ? kUnknown : found->second;
  }
  /// "x_m, y_m": for messages.
  [[nodiscard]] std::string outputNames() const;
};

/// One module of a Robot, a chassis, a gimbal, by its name in the configuration: a handle, cheap to copy,
/// valid as long as its Robot. Every member may be called from any thread.
class Module {
 public:
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Gives the module these inputs, once: nothing sends them again, so that a program that hangs lets go.
  /// Call it from a loop, more often than they lapse; they end with the Robot, too. They replace all inputs:
  /// the others have no value. The result says why they were not sent; whether the module takes them shows in
  /// state().owner.
  Result<void> send(const Signals& inputs, SendOptions options = {}) const;

  /// The newest outputs; before the first: none of them, and an age of ages.
  [[nodiscard]] ModuleState state() const;
  /// One of them; NaN: it means nothing now. A name that the module does not have is told as a problem.
  [[nodiscard]] double output(std::string_view name) const;
  /// Waits for outputs that are newer than those known. The error says what to check. Not in a callback.
  [[nodiscard]] Result<void> waitForState(Duration timeout = std::chrono::seconds{5}) const;

 private:
  friend class Robot;
  Module(RobotSession& session, std::string name) : session_(&session), name_(std::move(name)) {}

  RobotSession* session_;
  std::string name_;
};

}  // namespace robot_client
}  // namespace rc10
