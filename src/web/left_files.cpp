#include "web/left_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "config/yaml/source_text.hpp"

namespace rc10::web {

namespace fs = std::filesystem;

namespace {

// A file with mistakes is no YAML, perhaps: its line is looked for. Empty: there is none.
std::string_view robotNamedIn(std::string_view config) {
  constexpr std::string_view kKey = "robot:";
  for (std::size_t begin = 0; begin < config.size();) {
    const auto end = std::min(config.find('\n', begin), config.size());
    auto line = config.substr(begin, end - begin);
    begin = end + 1;
    if (!line.starts_with(kKey)) continue;
    constexpr std::string_view kAround = " \t\r\"'";
    line = line.substr(kKey.size());
    line.remove_prefix(std::min(line.find_first_not_of(kAround), line.size()));
    return line.substr(0, line.find_first_of(" \t\r\"'#"));
  }
  return {};
}

bool isOfAnother(const fs::path& path, const std::string& robot) {
  auto refused = path;
  const auto config = readLeft(refused.replace_extension(".refused").string());
  const auto named = config ? robotNamedIn(config->text) : std::string_view{};
  return !named.empty() && named != robot;
}

}  // namespace

bool isNewer(const timespec& a, const timespec& b) noexcept {
  return a.tv_sec != b.tv_sec ? a.tv_sec > b.tv_sec : a.tv_nsec > b.tv_nsec;
}

UniqueFd openLeftFile(const std::string& path, struct stat& status) {
  UniqueFd file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)};
  if (!file || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return file;
}

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

bool namesFiles(const std::string& robot) noexcept {
  return !robot.empty() && robot.find('/') == std::string::npos;
}

std::string newestLeftFile(const std::string& run_dir, std::string_view ending,
                           const std::optional<std::string>& robot) {
  std::string found;
  timespec written{};
  std::error_code error;
  for (fs::directory_iterator entry(run_dir, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() != ending) continue;
    struct stat status {};
    const auto path = entry->path().string();
    if (::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    if (!found.empty() && !isNewer(status.st_mtim, written)) continue;
    if (robot && isOfAnother(entry->path(), *robot)) continue;
    found = path;
    written = status.st_mtim;
  }
  return found;
}

}  // namespace rc10::web
