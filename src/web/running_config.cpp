#include "web/running_config.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include "config/sha256.hpp"
#include "link/config_copy.hpp"
#include "web/left_files.hpp"

namespace rc10::web {
namespace {

std::optional<LeftText> lastAccepted(const std::string& run_dir, const std::optional<std::string>& robot) {
  return readLeft(robot && namesFiles(*robot) ? link::configPath(run_dir, *robot)
                                              : newestLeftFile(run_dir, ".config"));
}

std::optional<std::string> onlyRobotIn(const std::string& run_dir) {
  std::optional<std::string> found;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(run_dir, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() != ".config") continue;
    if (found) return std::nullopt;
    found = entry->path().stem().string();
  }
  return found;
}

}  // namespace

FoundConfig readRunningConfig(const std::string& run_dir, const std::string& robot, const std::string& hash) {
  auto left = namesFiles(robot) ? readLeft(link::configPath(run_dir, robot)) : std::nullopt;
  if (!left || sha256(left->text) != hash) return {};
  return {"running", std::move(left->text)};
}

// The rights in one robot's file say nothing about another's.
std::optional<AcceptedConfig> readAcceptedConfig(const std::string& run_dir,
                                                 const std::optional<std::string>& robot) {
  const auto of = robot && !robot->empty() ? robot : onlyRobotIn(run_dir);
  if (!of || !namesFiles(*of)) return std::nullopt;
  auto left = readLeft(link::configPath(run_dir, *of));
  if (!left) return std::nullopt;
  return AcceptedConfig{.robot = *of, .text = std::move(left->text)};
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
