#pragma once

#include <string>

#include "blackbox/recording.hpp"

namespace rc10::client {

/// Summary of a recording for a person: how long it is, how much of what, how it ended, the last events.
/// `running`: the process that writes it is still there.
[[nodiscard]] std::string recordingText(const blackbox::Recording& recording, bool running);

}  // namespace rc10::client
