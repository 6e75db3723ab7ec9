#include "running_config.hpp"

#include <filesystem>
#include <string>

#include "config/load_config.hpp"
#include "link/config_copy.hpp"

namespace rc10::ctl {

std::optional<RobotConfig> runningConfig(const Global& global, const link::Welcome& welcome) {
  const auto socket = socketOf(global);
  if (!socket) return std::nullopt;
  const auto folder = std::filesystem::path(*socket).parent_path().string();
  return loadRobotConfig(link::configPath(folder, std::string{welcome.robot.view()})).config;
}

const MotorConfig* motorAt(const RobotConfig& config, std::size_t place) {
  for (const auto& bus : config.buses) {
    if (place < bus.motors.size()) return &bus.motors[place];
    place -= bus.motors.size();
  }
  return nullptr;
}

}  // namespace rc10::ctl
