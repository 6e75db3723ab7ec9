#include "daemon/rest_frames.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "app/errno_text.hpp"
#include "bus/frame_text.hpp"
#include "link/process_identity.hpp"
#include "link/run_dir.hpp"

namespace rc10 {
namespace {

[[nodiscard]] std::vector<AddressedFrame> restFrames(const Robot& robot) {
  std::vector<AddressedFrame> all;
  for (const auto& entry : robot.buses()) {
    if (entry.interface.empty()) continue;
    for (const CommandPacker* packer : entry.bus->packers()) {
      std::array<CanFrame, kMaxFramesPerPacker> frames{};
      const auto count = packer->packRest(frames);
      for (const CanFrame& frame : std::span(frames).first(count)) all.push_back({entry.interface, frame});
    }
  }
  return all;
}

[[nodiscard]] Result<void> failure(const std::string& path) {
  return fail(fmt::format("{}: {}", path, errnoText(errno)));
}

}  // namespace

std::string restFramesText(const Robot& robot, const std::string& name) {
  const auto frames = restFrames(robot);
  return fmt::format(
      "# rc10d, robot '{}': {}; rc10-stop sends them\n{}", name,
      frames.empty() ? "no drive on a CAN interface, no rest frames" : "the rest frames of every drive",
      frameListText(frames));
}

Result<void> writeRestFrames(const Robot& robot, const std::string& run_dir, const std::string& name) {
  const std::string path = link::restFramesPath(run_dir, name);
  const std::string dir = path.substr(0, path.rfind('/'));
  if (::mkdir(dir.c_str(), 0755) != 0 && errno != EEXIST) return failure(dir);
  const std::string text = link::ProcessIdentity::own().line() + "\n" + restFramesText(robot, name);
  const std::string temporary = path + ".new";
  UniqueFd file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644)};
  // No fsync: what outlives a power cut is not to be replayed.
  if (!file || ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    return failure(temporary);
  }
  file.reset();
  return ::rename(temporary.c_str(), path.c_str()) == 0 ? Result<void>{} : failure(path);
}

}  // namespace rc10
