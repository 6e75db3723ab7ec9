#include "client/obstacle.hpp"

#include <algorithm>
#include <cstddef>

#include "app/event_code.hpp"
#include "app/printable.hpp"
#include "link/words.hpp"

namespace rc10::client {

std::string obstacle(const link::State& state, const std::string& name, const link::MotorState& motor) {
  if (state.robot_state != RobotStatus::kRun) {
    return std::string("the robot is in ") + toString(state.robot_state) +
           ": `rc10ctl clear`, then `rc10ctl enable " + name + "`";
  }
  const std::string is = "motor '" + name + "' is " + toString(motor.status);
  switch (motor.status) {
    case MotorStatus::kActive: return {};
    case MotorStatus::kOffline:
      return is + ": check its power, wiring and id, then `rc10ctl enable " + name + "`";
    case MotorStatus::kFault:
      return is + " (" + link::faultText(motor.fault) + "): `rc10ctl clear " + name +
             "`, then `rc10ctl enable " + name + "`";
    default: return is + ": `rc10ctl enable " + name + "`";
  }
}

bool leavesActive(const link::Event& event) {
  const auto change = event.text.view();
  return EventCode{event.code} == EventCode::kMotorStatus &&
         (change.starts_with("ACTIVE -> ") ||
          (change.starts_with("ENABLING -> ") && !change.starts_with("ENABLING -> ACTIVE")));
}

bool leavesRun(const link::Event& event) {
  return EventCode{event.code} == EventCode::kRobotState && event.text.view().starts_with("RUN -> ");
}

std::string refusalText(const link::Event& event, std::string_view motor, std::string_view client) {
  const auto code = EventCode{event.code};
  const bool of_motor = code == EventCode::kSetpointSkipped || code == EventCode::kNotOwner;
  // Refused by admission before a motor had it: the text names the motor, and a range or right that it lacks.
  const bool of_message = code == EventCode::kCommandRefused;
  if ((of_motor && event.source.view() == motor) || (of_message && event.client.view() == client))
    return printable(event.text.view());
  return {};
}

std::string holder(const link::Welcome& welcome, std::string_view owner) {
  const auto count = std::min<std::size_t>(welcome.module_count, link::kMaxModules);
  for (std::size_t i = 0; i < count; ++i) {
    if (welcome.modules[i].view() == owner)
      return "the module '" + printable(owner) + "': end what commands it (`rc10ctl modules`)";
  }
  return "'" + printable(owner) + "': stop that program";
}

}  // namespace rc10::client
