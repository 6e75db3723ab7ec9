#pragma once

#include <string>

namespace rc10 {

/// Leaves in the run folder why rc10d did not start with this file, and the file's bytes, for rc10-web. Where
/// there is no folder, nothing is left.
void leaveRefusal(const std::string& config_file, const std::string& text, const std::string& source);
/// It has started with it.
void takeRefusalBack(const std::string& config_file);
/// Leaves the bytes of the file that runs, in the same way.
void leaveConfig(const std::string& robot, const std::string& source);

}  // namespace rc10
