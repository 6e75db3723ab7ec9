#pragma once

#include <string>

#include "blackbox/recording.hpp"

namespace rc10::client {

/// Summary of a recording for a person: how long it is, how much of what, how it ended, the last events.
/// `running`: the process that writes it is still there.
[[nodiscard]] std::string recordingText(const blackbox::Recording& recording, bool running);

/// An event of a recording in words; that of a module in its own.
[[nodiscard]] std::string eventText(const blackbox::Recording& recording, const blackbox::Event& event);

}  // namespace rc10::client
