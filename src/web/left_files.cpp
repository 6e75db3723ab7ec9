#include "web/left_files.hpp"

#include <fcntl.h>

#include <filesystem>
#include <system_error>

namespace rc10::web {

namespace fs = std::filesystem;

bool isNewer(const timespec& a, const timespec& b) noexcept {
  return a.tv_sec != b.tv_sec ? a.tv_sec > b.tv_sec : a.tv_nsec > b.tv_nsec;
}

UniqueFd openLeftFile(const std::string& path, struct stat& status) {
  UniqueFd file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)};
  if (!file || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return file;
}

std::string newestLeftFile(const std::string& run_dir, std::string_view ending) {
  std::string found;
  timespec written{};
  std::error_code error;
  for (fs::directory_iterator entry(run_dir, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() != ending) continue;
    struct stat status {};
    const auto path = entry->path().string();
    if (::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    if (!found.empty() && !isNewer(status.st_mtim, written)) continue;
    found = path;
    written = status.st_mtim;
  }
  return found;
}

}  // namespace rc10::web
