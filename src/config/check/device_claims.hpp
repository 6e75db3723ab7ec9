#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/robot_config.hpp"
#include "module/module_base.hpp"

namespace rc10 {

/// Users of serial ports, SPI devices and GPIO lines: each has one.
class DeviceClaims {
 public:
  /// With the lines that the robot itself has.
  explicit DeviceClaims(const RobotConfig& robot);

  /// Takes what `module` wants. Returns what somebody has already, with the module's key before it: "port:
  /// ...".
  [[nodiscard]] std::vector<std::string> claim(Module_Base& module, const std::string& name);

 private:
  void claimDevice(std::string_view key, const std::string& path, const std::string& module);
  void claimLine(const std::string& key, const GpioPin& pin, const std::string& owner);

  std::map<std::string, std::string> owners_;
  std::vector<std::string> taken_;
};

}  // namespace rc10
