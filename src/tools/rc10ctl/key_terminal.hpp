#pragma once

#include <termios.h>

#include <string>

#include "app/result.hpp"

namespace rc10::ctl {

/// The terminal of stdin, giving each key at once and showing none, as long as the object lives. Ctrl-C stays
/// a signal.
class KeyTerminal {
 public:
  /// The error says that there is no terminal.
  [[nodiscard]] static Result<KeyTerminal> open();

  KeyTerminal(KeyTerminal&& other) noexcept;
  KeyTerminal& operator=(KeyTerminal&&) = delete;
  KeyTerminal(const KeyTerminal&) = delete;
  KeyTerminal& operator=(const KeyTerminal&) = delete;
  ~KeyTerminal();

  /// Text typed since the last call; does not wait. Sets `closed` when the terminal has gone.
  [[nodiscard]] std::string typed(bool& closed) const;

 private:
  explicit KeyTerminal(const termios& before) : before_(before) {}

  termios before_;
  bool owns_ = true;
};

}  // namespace rc10::ctl
