#include "web/running_config.hpp"

#include <unistd.h>

#include "config/sha256.hpp"
#include "config/yaml/source_text.hpp"
#include "link/config_copy.hpp"
#include "web/left_files.hpp"

namespace rc10::web {
namespace {

struct LeftText {
  std::string text;
  timespec written{};
};

std::optional<LeftText> readLeft(const std::string& path) {
  struct stat status {};
  const auto file = openLeftFile(path, status);
  if (!file || status.st_size <= 0 || status.st_size > static_cast<off_t>(kMaxConfigBytes))
    return std::nullopt;
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  const auto size = ::pread(file.get(), text.data(), text.size(), 0);
  if (size != static_cast<ssize_t>(text.size())) return std::nullopt;
  return LeftText{std::move(text), status.st_mtim};
}

}  // namespace

FoundConfig readRunningConfig(const std::string& run_dir, const std::string& robot, const std::string& hash) {
  auto left =
      robot.find('/') == std::string::npos ? readLeft(link::configPath(run_dir, robot)) : std::nullopt;
  if (!left || sha256(left->text) != hash) return {};
  return {"running", std::move(left->text)};
}

FoundConfig readLastConfig(const std::string& run_dir, const std::optional<std::string>& robot) {
  const bool named = robot && !robot->empty() && robot->find('/') == std::string::npos;
  auto last = readLeft(named ? link::configPath(run_dir, *robot) : newestLeftFile(run_dir, ".config"));
  auto refused = readLeft(newestLeftFile(run_dir, ".refused"));
  if (refused && (!last || isNewer(refused->written, last->written)))
    return {"refused", std::move(refused->text)};
  if (last) return {"last", std::move(last->text)};
  return {};
}

}  // namespace rc10::web
