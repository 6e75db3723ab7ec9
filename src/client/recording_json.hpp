#pragma once

#include <string>

#include "blackbox/recording.hpp"

/// A recording as JSON, one object a line. Each has `utime` (us since 1970), `mono_us` and `kind`; other keys
/// are the field names of lcm_types/; modes and states are words.
namespace rc10::client {

/// Summary of a recording: {"kind":"recording","robot":...}.
[[nodiscard]] std::string recordingJson(const blackbox::Recording& recording);
[[nodiscard]] std::string recordJson(const blackbox::Recording& recording, const blackbox::Record& record);

}  // namespace rc10::client
