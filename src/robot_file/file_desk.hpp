#pragma once

#include <ctime>
#include <functional>
#include <string>

#include "app/result.hpp"
#include "client/file_request.hpp"
#include "link/process_identity.hpp"
#include "robot_file/config_folder.hpp"

namespace rc10::robot_file {

/// The sender of a request, as the kernel tells it.
struct Caller {
  link::ProcessIdentity process;
  uid_t user = 0;
};

/// Name of a robot's file, and its unit.
struct RobotPlace {
  std::string file;
  std::string unit;
};
/// NAME.yaml of rc10d@NAME, if there is such a file; else robot.yaml of rc10d.
[[nodiscard]] Result<RobotPlace> placeOf(const ConfigFolder& folder, const std::string& robot);

/// All that a decision needs of the computer. An error is the reason why not.
struct Computer {
  std::function<Result<void>(const Caller& caller, client::FileVerb verb)> authorise;
  /// rc10d's own verdict: what it prints about a text that it accepts.
  std::function<Result<std::string>(const std::string& text)> check;
  /// Whether a restart takes torque from no motor, and ends no e-stop.
  std::function<Result<void>(const std::string& robot, const std::string& unit)> at_rest;
  std::function<Result<void>(const std::string& unit)> restart;
};

/// One request, judged and done.
[[nodiscard]] client::FileAnswer answer(const client::FileRequest& request, const Caller& caller,
                                        const std::string& folder, const Computer& computer, std::time_t now);

}  // namespace rc10::robot_file
