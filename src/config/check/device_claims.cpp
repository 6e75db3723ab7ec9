#include "config/check/device_claims.hpp"

#include <cstddef>
#include <utility>

namespace rc10 {

DeviceClaims::DeviceClaims(const RobotConfig& robot) {
  if (robot.estop_gpio) claimLine("", robot.estop_gpio->pin, "estop_gpio");
  if (robot.enabling_gpio) claimLine("", robot.enabling_gpio->pin, "enabling_gpio");
  if (robot.mode_gpio) claimLine("", robot.mode_gpio->pin, "mode_gpio");
  if (robot.heartbeat_gpio) claimLine("", robot.heartbeat_gpio->pin, "heartbeat_gpio");
}

std::vector<std::string> DeviceClaims::claim(Module_Base& module, const std::string& name) {
  taken_.clear();
  if (const auto need = module.takeSerialNeed()) claimDevice("port", need->path, name);
  if (const auto need = module.takeSpiNeed()) claimDevice("device", need->path, name);
  if (const auto need = module.takeGpioNeed()) {
    const std::string of_module = "' of module '" + name + "'";
    const auto claim_lines = [&](const std::string& kind, const auto& lines) {
      for (std::size_t i = 0; i < lines.size(); ++i) {
        std::string key = kind;
        key.append("s[").append(std::to_string(i)).append("].line");
        std::string owner = kind;
        owner.append(" '").append(lines[i].name).append(of_module);
        claimLine(key, {need->chip, lines[i].line}, owner);
      }
    };
    claim_lines("input", need->inputs);
    claim_lines("output", need->outputs);
  }
  return std::exchange(taken_, {});
}

void DeviceClaims::claimDevice(std::string_view key, const std::string& path, const std::string& module) {
  const auto [first, is_new] = owners_.emplace(path, module);
  if (is_new) return;
  taken_.push_back(std::string{key} + ": " + path + " is that of module '" + first->second +
                   "' already; give each its own");
}

void DeviceClaims::claimLine(const std::string& key, const GpioPin& pin, const std::string& owner) {
  const auto [first, is_new] = owners_.emplace(pin.sameName(), owner);
  if (is_new) return;
  taken_.push_back(key + ": " + pin.name() + " is the line of " + first->second +
                   " already; use another line for " + owner);
}

}  // namespace rc10
