#include "daemon/clients/link_socket.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include <fmt/format.h>

#include "app/account_ids.hpp"
#include "app/errno_text.hpp"
#include "link/process_identity.hpp"
#include "link/run_dir.hpp"
#include "link/unix_address.hpp"

namespace rc10 {
namespace {

constexpr int kBacklog = 16;

[[nodiscard]] std::string whoHolds(const std::string& path, pid_t pid, const std::string& robot) {
  if (pid > 0 && link::ProcessIdentity{.pid = pid, .start_ticks = 0}.runs())
    return fmt::format(
        "robot '{}' already has a running rc10d (pid {}): stop it first, or give this robot another name",
        robot, pid);
  return fmt::format(
      "the lock of robot '{}' is held by another program (`sudo fuser -v {}` names it): end it", robot, path);
}

[[nodiscard]] Result<UniqueFd> takeLock(const std::string& path, const std::string& robot) {
  // Nobody else may open it: who can read a file can lock it.
  UniqueFd lock{::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)};
  if (!lock) return fail(fmt::format("{}: {}", path, errnoText(errno)));
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    char holder[16] = {};
    (void)!::read(lock.get(), holder, sizeof holder - 1);
    return fail(whoHolds(path, std::atoi(holder), robot));
  }
  (void)::fchmod(lock.get(), 0600);  // one that an older rc10d has left
  const std::string pid = std::to_string(::getpid());
  (void)!::ftruncate(lock.get(), 0);
  (void)!::write(lock.get(), pid.data(), pid.size());
  return lock;
}

// The caller holds the lock: a file of that name was left by one that was killed.
[[nodiscard]] Result<UniqueFd> bindSocket(const std::string& path, int type) {
  const auto address = link::unixAddress(path);
  if (!address) {
    return fail(
        fmt::format("{}: longer than the {} bytes a socket path may have: choose a shorter RC10_RUN_DIR",
                    path, link::kMaxSocketPath));
  }
  UniqueFd socket{::socket(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (socket) (void)::unlink(path.c_str());
  if (!socket || ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return fail(fmt::format("{}: {}", path, errnoText(errno)));
  (void)::chmod(path.c_str(), 0660);
  if (const auto gid = groupId("rc10")) (void)!::chown(path.c_str(), static_cast<uid_t>(-1), *gid);
  return socket;
}

}  // namespace

Result<LinkSocket> LinkSocket::listen(const std::string& dir, const std::string& robot) {
  if (auto made = link::makeRunDir(dir); !made) return tl::unexpected(made.error());
  LinkSocket link;
  auto lock = takeLock(dir + "/" + robot + ".lock", robot);
  if (!lock) return tl::unexpected(lock.error());
  link.lock_ = std::move(*lock);
  const std::string path = dir + "/" + robot + ".sock";
  auto socket = bindSocket(path, SOCK_SEQPACKET);
  if (!socket) return tl::unexpected(socket.error());
  auto estop = bindSocket(link::estopPath(path), SOCK_DGRAM);
  if (!estop) return tl::unexpected(estop.error());
  link.socket_ = std::move(*socket);
  link.estop_ = std::move(*estop);
  link.path_ = path;
  if (::listen(link.socket_.get(), kBacklog) != 0) return fail(fmt::format("{}: {}", path, errnoText(errno)));
  return link;
}

LinkSocket::~LinkSocket() {
  if (!socket_) return;
  (void)::unlink(path_.c_str());
  (void)::unlink(link::estopPath(path_).c_str());
}

}  // namespace rc10
