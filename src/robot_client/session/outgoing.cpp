#include "robot_client/session/outgoing.hpp"

#include "app/utime.hpp"
#include "rc10/command_t.hpp"
#include "rc10/request_t.hpp"
#include "rc10/signals_t.hpp"
#include "robot_client/convert.hpp"
#include "robot_client/session/session_number.hpp"

namespace rc10 {
inline namespace robot_client {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

Outgoing::Outgoing(LcmLink link, std::string robot, std::string client, int priority)
    : link_(std::move(link)),
      robot_(std::move(robot)),
      client_(std::move(client)),
      priority_(priority),
      session_(newSessionNumber()) {}

Result<void> Outgoing::command(const MotorSetpoints& setpoints, std::chrono::milliseconds validity) {
  command_t message;
  message.utime = utimeOf(std::chrono::system_clock::now());
  message.client = client_;
  message.session = session_;
  message.seq = nextNumber();
  message.priority = priority_;
  message.validity_ms = static_cast<std::int32_t>(validity.count());
  for (const auto& order : setpoints) message.setpoints.push_back(toLcm(order));
  message.setpoint_count = static_cast<std::int32_t>(message.setpoints.size());
  return link_.publish(channel("command"), message);
}

Result<void> Outgoing::inputs(const std::string& module, const Signals& inputs, const SendOptions& options) {
  signals_t message;
  message.utime = utimeOf(std::chrono::system_clock::now());
  message.client = client_;
  message.session = session_;
  message.seq = nextNumber();
  message.priority = options.priority.value_or(priority_);
  message.validity_ms = static_cast<std::int32_t>(options.validity.count());
  for (const auto& [name, value] : inputs) {
    message.names.push_back(name);
    message.values.push_back(value);
  }
  message.count = static_cast<std::int32_t>(inputs.size());
  return link_.publish(channel(module), message);
}

Result<void> Outgoing::request(std::int64_t number, const std::string& operation, const std::string& target,
                               const std::map<std::string, double>& values) {
  request_t message;
  message.utime = utimeOf(std::chrono::system_clock::now());
  message.client = client_;
  message.session = session_;
  message.seq = number;
  message.operation = operation;
  message.target = target;
  for (const auto& [name, value] : values) {
    named_value_t named;
    named.name = name;
    named.value = value;
    message.values.push_back(std::move(named));
  }
  message.value_count = static_cast<std::int32_t>(message.values.size());
  return link_.publish(channel("request"), message);
}

}  // namespace robot_client
}  // namespace rc10
