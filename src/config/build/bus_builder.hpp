#pragma once

#include <string>
#include <vector>

#include "config/build/motor_builder.hpp"
#include "config/keys/profiles.hpp"
#include "config/keys/unique_names.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Builds the buses of a robot, one after the other, with the checks that span them.
class BusBuilder {
 public:
  BusBuilder(Profiles& profiles, int rate_hz, Problems& problems)
      : profiles_(profiles), rate_hz_(rate_hz), problems_(problems) {}

  /// `node`: the checked section of one bus.
  [[nodiscard]] BusConfig build(const YamlNode& node, const std::string& path);

 private:
  void readPlain(const Settings& settings, BusConfig& bus);
  void checkInterface(const Settings& settings, const BusConfig& bus, const std::string& path);
  void checkDataBitrate(const Settings& settings, const BusConfig& bus);
  std::vector<MotorDraft> buildMotors(const Settings& settings);
  void checkBitrate(const Settings& settings, BusConfig& bus, const std::vector<MotorDraft>& motors);

  Profiles& profiles_;
  int rate_hz_;
  Problems& problems_;
  UniqueNames bus_names_{"bus name", "the robot"};
  UniqueNames interfaces_{"interface", "the robot"};
  UniqueNames motor_names_{"motor name", "the robot, over all buses"};
};

}  // namespace rc10
