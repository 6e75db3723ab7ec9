#include "web/running_config.hpp"

#include "config/sha256.hpp"
#include "link/config_copy.hpp"
#include "web/left_files.hpp"

namespace rc10::web {
FoundConfig readRunningConfig(const std::string& run_dir, const std::string& robot, const std::string& hash) {
  auto left =
      robot.find('/') == std::string::npos ? readLeft(link::configPath(run_dir, robot)) : std::nullopt;
  if (!left || sha256(left->text) != hash) return {};
  return {"running", std::move(left->text)};
}

FoundConfig readLastConfig(const std::string& run_dir, const std::optional<std::string>& robot) {
  const bool named = robot && !robot->empty() && robot->find('/') == std::string::npos;
  auto last = readLeft(named ? link::configPath(run_dir, *robot) : newestLeftFile(run_dir, ".config"));
  auto refused = readLeft(newestLeftFile(run_dir, ".refused", robot));
  if (refused && (!last || isNewer(refused->written, last->written)))
    return {"refused", std::move(refused->text)};
  if (last) return {"last", std::move(last->text)};
  return {};
}

}  // namespace rc10::web
