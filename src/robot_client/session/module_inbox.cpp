#include "robot_client/session/module_inbox.hpp"

#include <algorithm>
#include <cmath>

#include "app/message_limits.hpp"

namespace rc10 {
inline namespace robot_client {
std::string ModuleState::outputNames() const {
  std::string names;
  for (const auto& [name, value] : outputs) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? "none" : names;
}

const ModuleInbox& ModuleInboxes::of(const LcmLink& link, const std::string& channel) {
  const std::lock_guard lock(mutex_);
  auto& inbox = inboxes_[channel];
  if (!inbox) inbox = std::make_unique<const ModuleInbox>(link, channel);
  return *inbox;
}

ModuleState ModuleInbox::state() const {
  ModuleState state;
  const auto latest = outputs_.latest();
  if (!latest) return state;
  const auto& message = latest->message;
  const auto count = std::min(message.names.size(), message.values.size());
  for (std::size_t i = 0; i < count; ++i) state.outputs[message.names[i]] = message.values[i];
  state.owner = message.client;
  state.received = latest->received;
  return state;
}

Result<void> checkInputs(const std::string& module, const Signals& inputs, const SendOptions& options) {
  if (inputs.empty() || inputs.size() > kMaxMessageSignals) {
    return fail(module + " takes 1 to " + std::to_string(kMaxMessageSignals) + " inputs, not " +
                std::to_string(inputs.size()));
  }
  if (options.validity.count() < 0 || options.validity > kMaxValidity) {
    return fail(module + ": validity is not within 1 to " +
                std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(kMaxValidity).count()) +
                " ms");
  }
  for (const auto& [name, value] : inputs) {
    std::string input = module;
    input += ": ";
    input += name;
    if (name.empty() || name.size() > kMaxNameBytes) {
      return fail(input + " is no input's name: that has 1 to " + std::to_string(kMaxNameBytes) +
                  " characters");
    }
    if (!std::isfinite(value)) return fail(input + " is not finite: leave it out, or give a number");
  }
  return {};
}

}  // namespace robot_client
}  // namespace rc10
