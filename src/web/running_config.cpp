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

namespace {

std::optional<LeftText> lastAccepted(const std::string& run_dir, const std::optional<std::string>& robot) {
  const bool named = robot && !robot->empty() && robot->find('/') == std::string::npos;
  return readLeft(named ? link::configPath(run_dir, *robot) : newestLeftFile(run_dir, ".config"));
}

}  // namespace

std::string readAcceptedConfig(const std::string& run_dir, const std::optional<std::string>& robot) {
  auto last = lastAccepted(run_dir, robot);
  return last ? std::move(last->text) : std::string{};
}

FoundConfig readLastConfig(const std::string& run_dir, const std::optional<std::string>& robot) {
  auto last = lastAccepted(run_dir, robot);
  auto refused = readLeft(newestLeftFile(run_dir, ".refused", robot));
  if (refused && (!last || isNewer(refused->written, last->written)))
    return {"refused", std::move(refused->text)};
  if (last) return {"last", std::move(last->text)};
  return {};
}

}  // namespace rc10::web
