#pragma once

#include <string>

#include "config/robot_config.hpp"

namespace rc10 {

/// A motor as far as it could be read, with what checks across motors need to name it.
struct MotorDraft {
  MotorConfig config;
  std::string path;  ///< "buses[0].motors[2]"
  SourcePlace id_place;
  bool complete = false;  ///< Model, id and command are known and fit together.
};

/// "'lift' (M3508 id 1)"
[[nodiscard]] std::string nameOf(const MotorDraft& motor);

}  // namespace rc10
