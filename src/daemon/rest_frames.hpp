#pragma once

#include <string>

#include "app/result.hpp"
#include "daemon/devices/robot.hpp"

namespace rc10 {

/// The rest frames of every drive on a real interface, as rc10-stop replays them (bus/frame_text.hpp). They
/// come from the packers, so each family has them. Main thread, before the first tick.
[[nodiscard]] std::string restFramesText(const Robot& robot, const std::string& name);

/// Writes link::restFramesPath() for rc10-stop, whole or not at all, with the identity of this process. To be
/// called while the robot's locks are held and before anything is sent. It stays after a clean end, where it
/// does no harm: rest is what the drives were told last.
[[nodiscard]] Result<void> writeRestFrames(const Robot& robot, const std::string& run_dir,
                                           const std::string& name);

}  // namespace rc10
