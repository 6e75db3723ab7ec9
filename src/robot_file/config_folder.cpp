#include "robot_file/config_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "app/errno_text.hpp"
#include "client/file_request.hpp"

namespace rc10::robot_file {
namespace {

constexpr mode_t kModeOfNew = 0644;
constexpr mode_t kPermissions = 0777;

// "2026-11-26T15-04-05Z": names in the order of time.
constexpr const char* kTimeFormat = "%Y-%m-%dT%H-%M-%SZ";

std::string timeText(std::time_t now) {
  std::tm utc{};
  std::array<char, 32> text{};
  (void)::gmtime_r(&now, &utc);
  return {text.data(), std::strftime(text.data(), text.size(), kTimeFormat, &utc)};
}

// None: it was not written by timeText().
std::optional<std::time_t> timeIn(const std::string& text) {
  std::tm utc{};
  if (::strptime(text.c_str(), kTimeFormat, &utc) == nullptr) return std::nullopt;
  const auto time = ::timegm(&utc);
  return timeText(time) == text ? std::optional{time} : std::nullopt;
}

bool writeAll(int file, std::string_view text) {
  while (!text.empty()) {
    const auto written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

Result<ConfigFolder> ConfigFolder::open(const std::string& path) {
  UniqueFd folder{::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)};
  if (!folder) return fail("cannot open " + path + ": " + errnoText(errno));
  while (::flock(folder.get(), LOCK_EX) != 0) {
    if (errno != EINTR) return fail("cannot lock " + path + ": " + errnoText(errno));
  }
  return ConfigFolder{path, std::move(folder)};
}

tl::unexpected<Error> ConfigFolder::failed(const std::string& what, const std::string& name) const {
  return fail("cannot " + what + " " + pathOf(name) + ": " + errnoText(errno));
}

Result<std::optional<std::string>> ConfigFolder::read(const std::string& name) const {
  const UniqueFd file{::openat(folder_.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
  if (!file && errno == ENOENT) return std::optional<std::string>{};
  struct stat status {};
  if (!file && errno != ELOOP) return failed("open", name);
  if (!file || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    return fail(pathOf(name) + " is a link or no file: install by hand");
  if (static_cast<std::size_t>(status.st_size) > client::FileRequest::kMostTextBytes)
    return fail(pathOf(name) + " is larger than 128 KiB: install by hand");
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  const auto size = ::pread(file.get(), text.data(), text.size(), 0);
  if (size < 0) return failed("read", name);
  text.resize(static_cast<std::size_t>(size));
  return text;
}

// A second name of the old file, so that nothing is copied, and at no time it is missing. A computer without
// a clock of its own may think that it is earlier than it was: the newest one has the last name all the same.
Result<std::string> ConfigFolder::keep(const std::string& name, std::time_t now) const {
  const auto before = backupTimes(name);
  if (!before.empty()) now = std::max(now, before.back() + 1);
  auto backup = name + "." + timeText(now);
  if (::linkat(folder_.get(), name.c_str(), folder_.get(), backup.c_str(), 0) == 0) return backup;
  if (errno == ENOENT) return std::string{};
  return failed("keep a backup of", name);
}

Result<std::string> ConfigFolder::replace(const std::string& name, const std::string& text,
                                          std::time_t now) const {
  struct stat old {};
  const bool is_new = ::fstatat(folder_.get(), name.c_str(), &old, AT_SYMLINK_NOFOLLOW) != 0;
  if (is_new && errno != ENOENT) return failed("look at", name);
  if (!is_new && !S_ISREG(old.st_mode)) return fail(pathOf(name) + " is a link or no file: install by hand");
  const auto fresh = "." + name + ".new";
  // Left by one that lost its power.
  (void)::unlinkat(folder_.get(), fresh.c_str(), 0);
  UniqueFd file{
      ::openat(folder_.get(), fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600)};
  if (!file) return failed("write", fresh);
  const bool written =
      writeAll(file.get(), text) && (is_new || ::fchown(file.get(), old.st_uid, old.st_gid) == 0) &&
      ::fchmod(file.get(), is_new ? kModeOfNew : old.st_mode & kPermissions) == 0 && ::fsync(file.get()) == 0;
  if (!written) {
    auto error = failed("write", fresh);
    (void)::unlinkat(folder_.get(), fresh.c_str(), 0);
    return error;
  }
  auto backup = keep(name, now);
  if (!backup) {
    (void)::unlinkat(folder_.get(), fresh.c_str(), 0);
    return backup;
  }
  if (::renameat(folder_.get(), fresh.c_str(), folder_.get(), name.c_str()) != 0 ||
      ::fsync(folder_.get()) != 0)
    return failed("replace", name);
  dropOldBackups(name);
  return backup;
}

std::vector<std::time_t> ConfigFolder::backupTimes(const std::string& name) const {
  const auto prefix = name + ".";
  std::vector<std::time_t> times;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(path_, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto file = entry->path().filename().string();
    if (!file.starts_with(prefix)) continue;
    if (const auto time = timeIn(file.substr(prefix.size()))) times.push_back(*time);
  }
  std::sort(times.begin(), times.end());
  return times;
}

void ConfigFolder::dropOldBackups(const std::string& name) const {
  const auto times = backupTimes(name);
  for (std::size_t i = 0; i + kBackups < times.size(); ++i)
    (void)::unlinkat(folder_.get(), (name + "." + timeText(times[i])).c_str(), 0);
}

}  // namespace rc10::robot_file
