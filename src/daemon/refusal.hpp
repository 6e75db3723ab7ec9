#pragma once

#include <string>

namespace rc10 {

/// Leaves in the run folder why rc10d did not start with this file, for rc10-web. Where there is no folder,
/// nothing is left.
void leaveRefusal(const std::string& config_file, const std::string& text);
/// It has started with it.
void takeRefusalBack(const std::string& config_file);

}  // namespace rc10
