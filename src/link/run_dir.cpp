#include "link/run_dir.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"

namespace rc10::link {
namespace {

constexpr const char* kRemedy =
    "set RC10_RUN_DIR to a folder of this user, such as $XDG_RUNTIME_DIR/rc10, or run as root";

// Nobody but root makes or replaces something in it.
bool isRootsAlone(const std::filesystem::path& dir) noexcept {
  struct stat status {};
  return ::stat(dir.c_str(), &status) == 0 && status.st_uid == 0 &&
         (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

std::string runDir() {
  const char* dir = std::getenv("RC10_RUN_DIR");
  return dir != nullptr && *dir != '\0' ? dir : "/run/rc10d";
}

Result<void> makeRunDir(const std::string& dir, uid_t user) {
  if (::mkdir(dir.c_str(), 0755) != 0 && errno != EEXIST)
    return fail(dir + ": " + errnoText(errno) + ": " + kRemedy);
  struct stat status {};
  const UniqueFd folder{::open(dir.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)};
  if (!folder && errno != ELOOP && errno != ENOTDIR) return fail(dir + ": " + errnoText(errno));
  if (!folder || ::fstat(folder.get(), &status) != 0)
    return fail(dir + " is no folder of its own (a link, or a file): " + kRemedy);
  if ((status.st_mode & S_IWOTH) != 0) return fail(dir + ": every user may write to it: " + kRemedy);
  // A group of the same number is its user's alone.
  if ((status.st_mode & S_IWGRP) != 0 && status.st_gid != status.st_uid)
    return fail(dir + ": its group may write to it, and so replace sockets: `chmod g-w " + dir + "`");
  const bool ours = status.st_uid == 0 || status.st_uid == user;
  // One that systemd made for the service belongs to the user rc10, in a folder of root's.
  if (!ours && !isRootsAlone(std::filesystem::path(dir).parent_path()))
    return fail(dir + " belongs to another user (uid " + std::to_string(status.st_uid) + "): " + kRemedy);
  return {};
}

std::string socketPath(const std::string& robot) { return runDir() + "/" + robot + ".sock"; }

std::string estopPath(const std::string& socket_path) {
  return std::filesystem::path(socket_path).replace_extension(".estop").string();
}

std::string restFramesPath(const std::string& run_dir, const std::string& robot) {
  return run_dir + "/" + robot + "/rest-frames";
}

std::string logPath(const std::string& run_dir, const std::string& robot) {
  return run_dir + "/" + robot + ".log";
}

std::string refusalPath(const std::string& run_dir, const std::string& config_file) {
  return run_dir + "/" + std::filesystem::path(config_file).stem().string() + ".refusal";
}

std::string guardSocketPath(const std::string& run_dir) { return run_dir + "/guard.socket"; }

}  // namespace rc10::link
