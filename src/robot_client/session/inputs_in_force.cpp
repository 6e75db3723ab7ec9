#include "robot_client/session/inputs_in_force.hpp"

#include <chrono>
#include <utility>

#include "app/message_limits.hpp"
#include "robot_client/session/event_codes.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

// "READY -> ENABLING"
[[nodiscard]] bool isEnabled(const Event& event) {
  return event.code == kMotorStatus && event.text.find(" -> ENABLING") != std::string::npos;
}

}  // namespace

void InputsInForce::give(const std::string& module, const Signals& inputs, const SendOptions& options,
                         MonotonicTime now) {
  const Duration validity = options.validity == milliseconds{0} ? kDefaultValidity : options.validity;
  by_module_[module] = {{inputs, options}, now + validity};
}

void InputsInForce::onEvent(const Event& event) {
  if (isEnabled(event)) by_module_.clear();
}

std::map<std::string, InputsInForce::Given> InputsInForce::takeAll(MonotonicTime now) {
  std::map<std::string, Given> all;
  for (auto& [module, timed] : by_module_) {
    if (now >= timed.until) continue;
    timed.given.options.validity = kEndValidity;
    all.emplace(module, std::move(timed.given));
  }
  by_module_.clear();
  return all;
}

}  // namespace robot_client
}  // namespace rc10
