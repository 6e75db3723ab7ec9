#include "key_terminal.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace rc10::ctl {

Result<KeyTerminal> KeyTerminal::open() {
  termios before{};
  if (::tcgetattr(STDIN_FILENO, &before) != 0)
    return fail("keys come from a terminal, and this is none: run it in one (over ssh: `ssh -t`)");
  termios keys = before;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  keys.c_cc[VMIN] = 0;
  keys.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  return KeyTerminal(before);
}

KeyTerminal::KeyTerminal(KeyTerminal&& other) noexcept
    : before_(other.before_), owns_(std::exchange(other.owns_, false)) {}

KeyTerminal::~KeyTerminal() {
  // Keys still in the buffer were meant for the motor, not for the shell.
  if (owns_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
}

std::string KeyTerminal::typed(bool& closed) const {
  pollfd entry{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (::poll(&entry, 1, 0) <= 0) return {};
  std::array<char, 256> bytes{};
  const auto size = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  closed = size == 0 || (entry.revents & (POLLHUP | POLLERR)) != 0;
  return {bytes.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

}  // namespace rc10::ctl
