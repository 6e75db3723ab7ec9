#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "rc10/robot_state.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

/// The targets that are sent again and again, and when a target stops being held. Targets of one message
/// stay in one message. Pure: the time is an argument.
class HeldTargets {
 public:
  /// A motor that is not held any more, and why.
  struct Dropped {
    std::string motor;
    std::string reason;
  };

  /// `resend`: 0: the program sends its targets itself. `validity`: how long one acts. `lapse`: how long it
  /// is held after the program's last sign of life; 0: for ever.
  HeldTargets(Duration resend, Duration validity, Duration lapse)
      : resend_(resend), validity_(validity), lapse_(lapse) {}

  /// Holds what has just been sent. Motors leave the message in which they were before; COAST needs no
  /// holding. `shown_us`: RobotState::mono_us of the newest state.
  void set(const MotorSetpoints& message, MonotonicTime now, std::int64_t shown_us = 0);
  void release(const std::string& motor);
  void releaseAll() { messages_.clear(); }
  /// Gives up all that is held. Returns, message by message, what is still in force: a target that lapsed
  /// while the program stood would let go of what holds its motor since.
  [[nodiscard]] std::vector<MotorSetpoints> takeAll(MonotonicTime now);
  /// The program lives.
  void alive(MonotonicTime now) noexcept { last_life_ = now; }

  [[nodiscard]] bool holds(const std::string& motor) const;
  [[nodiscard]] std::vector<std::string> motors() const;

  /// When the next message has to be sent again; none while nothing is held.
  [[nodiscard]] std::optional<MonotonicTime> nextDue() const;
  /// The messages that are due, counted as sent. After a pause of the program first a state of after it has
  /// to show that the motors have not been enabled anew meanwhile: events of a pause may be lost.
  [[nodiscard]] std::vector<MotorSetpoints> takeDue(MonotonicTime now);

  /// To be called with every state that comes after set(). Drops the motors that cannot obey any more or that
  /// another client has taken. So a target never comes back to life when somebody enables the motor or lets
  /// go of it: the program has to set it anew.
  [[nodiscard]] std::vector<Dropped> judge(const RobotState& state, const std::string& client);
  /// The same for an event: a motor may be disabled and enabled between two states.
  [[nodiscard]] std::vector<Dropped> judge(const Event& event);
  /// Drops everything if the program has not shown life for too long.
  [[nodiscard]] std::vector<Dropped> lapse(MonotonicTime now);

 private:
  struct Message {
    MotorSetpoints setpoints;
    MonotonicTime set_at;
    MonotonicTime sent;
    MonotonicTime due;
    std::int64_t shown_us = 0;
    std::optional<MonotonicTime> resumed{};  ///< A pause ended then, and no state of after it has come.
    bool confirmed = false;                  ///< Such a state has come, and nothing was sent since.
  };

  Duration resend_;
  Duration validity_;
  Duration lapse_;
  MonotonicTime last_life_{};
  std::vector<Message> messages_;
};

}  // namespace robot_client
}  // namespace rc10
