#include "app/stderr_lines.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>

namespace rc10 {

UniqueFd unblockedTerminal(int fd) noexcept {
  if (::isatty(fd) == 0) return {};
  const std::string path = "/proc/self/fd/" + std::to_string(fd);
  return UniqueFd{::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
}

namespace {

bool isWhole(ssize_t written, const std::string& line) noexcept {
  return written == static_cast<ssize_t>(line.size());
}

}  // namespace

StderrLines::StderrLines(int fd) noexcept : fd_(fd), terminal_(unblockedTerminal(fd)) {}

bool StderrLines::tell(std::string line) const noexcept {
  line += '\n';
  if (terminal_) return isWhole(::write(terminal_.get(), line.data(), line.size()), line);
  const auto sent = ::send(fd_, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent >= 0 || errno != ENOTSOCK) return isWhole(sent, line);
  // pipe(7): one that has room has it for PIPE_BUF bytes.
  pollfd room{.fd = fd_, .events = POLLOUT, .revents = 0};
  if (::poll(&room, 1, 0) != 1 || (room.revents & POLLOUT) == 0) return false;
  return isWhole(::write(fd_, line.data(), line.size()), line);
}

}  // namespace rc10
