#include "guard/guard_socket.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "app/errno_text.hpp"
#include "link/run_dir.hpp"
#include "link/unix_address.hpp"

namespace rc10::guard {
namespace {

constexpr int kBacklog = 8;

tl::unexpected<Error> failure(const std::string& path) { return fail(path + ": " + errnoText(errno)); }

UniqueFd spareDescriptor() noexcept { return UniqueFd{::open("/dev/null", O_RDONLY | O_CLOEXEC)}; }

bool mayHaveAGuard(int connection) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  return ::getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
         (peer.uid == 0 || peer.uid == ::geteuid());
}

}  // namespace

Result<GuardSocket> GuardSocket::listen(const std::string& run_dir) {
  if (auto made = link::makeRunDir(run_dir); !made) return tl::unexpected(made.error());
  GuardSocket guard;
  const std::string path = link::guardSocketPath(run_dir);
  const std::string lock_path = path + ".lock";
  guard.lock_ = UniqueFd{::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)};
  if (!guard.lock_) return failure(lock_path);
  if (::flock(guard.lock_.get(), LOCK_EX | LOCK_NB) != 0)
    return fail("there is another rc10-guard in " + run_dir);
  const auto address = link::unixAddress(path);
  if (!address) return fail(path + ": too long for a socket: choose a shorter RC10_RUN_DIR");
  guard.socket_ = UniqueFd{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (guard.socket_) (void)::unlink(path.c_str());  // left by one that was killed: we hold the lock
  if (!guard.socket_ ||
      ::bind(guard.socket_.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return failure(path);
  guard.path_ = path;
  (void)::chmod(path.c_str(), 0600);
  guard.spare_ = spareDescriptor();
  if (!guard.spare_ || ::listen(guard.socket_.get(), kBacklog) != 0) return failure(path);
  return guard;
}

GuardSocket::~GuardSocket() {
  if (socket_) (void)::unlink(path_.c_str());
}

GuardSocket::Accepted GuardSocket::accept() noexcept {
  Accepted accepted{.connection =
                        UniqueFd{::accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)}};
  if (!accepted.connection && (errno == EMFILE || errno == ENFILE)) {
    // One that stayed in the queue would wake a thread above all others again and again.
    spare_.reset();
    accepted.sent_away =
        static_cast<bool>(UniqueFd{::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC)});
    spare_ = spareDescriptor();
  }
  if (accepted.connection && !mayHaveAGuard(accepted.connection.get())) accepted.connection.reset();
  return accepted;
}

}  // namespace rc10::guard
