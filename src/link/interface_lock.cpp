#include "link/interface_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

namespace rc10::link {
namespace {

// holder() of another program has the lock for an instant: that is no reason not to start.
constexpr int kAttempts = 5;
constexpr auto kPause = std::chrono::milliseconds{10};

std::string folder(const std::string& run_dir) { return run_dir + "/locks"; }

// As /proc/self/ns/net shows it; 0 where there is no /proc.
ino_t networkNamespace() noexcept {
  struct stat status {};
  return ::stat("/proc/self/ns/net", &status) == 0 ? status.st_ino : 0;
}

// Text that another process wrote, for a message: of one line.
std::string firstLine(int file) {
  std::array<char, 128> bytes{};
  const auto size = ::pread(file, bytes.data(), bytes.size(), 0);
  std::string text(bytes.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  text.resize(std::min(text.find('\n'), text.size()));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.empty() ? "another rc10d" : text;
}

// Files that root makes for a tool that came first must not lock out the user of the service, who owns the
// run folder.
void giveToOwnerOf(const std::string& run_dir, const std::string& dir, int file) noexcept {
  struct stat owner {};
  struct stat status {};
  if (::geteuid() != 0 || ::stat(run_dir.c_str(), &owner) != 0) return;
  (void)!::lchown(dir.c_str(), owner.st_uid, owner.st_gid);
  if (::fstat(file, &status) == 0 && status.st_nlink == 1) (void)!::fchown(file, owner.st_uid, owner.st_gid);
}

bool lockFile(int file) noexcept {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (attempt != 0) std::this_thread::sleep_for(kPause);
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) return true;
  }
  return false;
}

}  // namespace

std::string InterfaceLock::path(const std::string& run_dir, const std::string& interface) {
  return folder(run_dir) + "/" + interface + "-" + std::to_string(networkNamespace()) + ".lock";
}

Result<InterfaceLock> InterfaceLock::take(const std::string& run_dir, const std::string& interface,
                                          const std::string& robot) {
  const std::string dir = folder(run_dir);
  if (::mkdir(dir.c_str(), 0755) != 0 && errno != EEXIST) {
    return fail(dir + ": " + std::strerror(errno) + ": set RC10_RUN_DIR to a folder this user may write to");
  }
  // The file stays when its holder ends: removing it would let two processes lock two files of one name.
  const std::string file_path = path(run_dir, interface);
  UniqueFd file{::open(file_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644)};
  if (!file) {
    return fail(file_path + ": " + std::strerror(errno) + ": remove it if no rc10d of another user runs");
  }
  giveToOwnerOf(run_dir, dir, file.get());
  if (!lockFile(file.get())) {
    return fail(interface + " is driven by " + firstLine(file.get()) + "; stop it first");
  }
  const std::string words = "robot '" + robot + "' (rc10d, pid " + std::to_string(::getpid()) + ")\n";
  if (::ftruncate(file.get(), 0) != 0 ||
      ::pwrite(file.get(), words.data(), words.size(), 0) != static_cast<ssize_t>(words.size())) {
    return fail(file_path + ": " + std::strerror(errno));
  }
  return InterfaceLock{std::move(file)};
}

std::string InterfaceLock::holder(const std::string& run_dir, const std::string& interface) {
  const std::string file_path = path(run_dir, interface);
  const UniqueFd file{::open(file_path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)};
  // Without the file nobody holds it. What may not be looked at is held, to be on the safe side.
  if (!file) return errno == ENOENT || errno == ENOTDIR ? "" : file_path + " (" + std::strerror(errno) + ")";
  return ::flock(file.get(), LOCK_SH | LOCK_NB) == 0 ? "" : firstLine(file.get());
}

}  // namespace rc10::link
