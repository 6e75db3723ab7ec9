#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/unique_fd.hpp"

namespace rc10::test {

/// A serial device that is a pseudo terminal: what it sends and receives is on the master's side.
class Pty {
 public:
  Pty() {
    if (!master_ || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0) {
      throw std::runtime_error("no pseudo terminal");
    }
    std::array<char, 64> name{};
    if (::ptsname_r(master_.get(), name.data(), name.size()) != 0) throw std::runtime_error("no name");
    path_ = name.data();
  }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] int master() const noexcept { return master_.get(); }
  /// The port sees a hang-up, as when a USB adapter is pulled.
  void unplug() noexcept { master_.reset(); }

  void send(std::span<const std::uint8_t> bytes) const {
    if (::write(master_.get(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the pseudo terminal does not take it");
    }
  }
  void send(std::initializer_list<std::uint8_t> bytes) const { send(std::vector<std::uint8_t>(bytes)); }
  /// Bytes that the port has sent and nobody has read yet.
  [[nodiscard]] std::vector<std::uint8_t> received() const {
    std::vector<std::uint8_t> all;
    std::array<std::uint8_t, 4096> part;
    for (ssize_t n; (n = ::read(master_.get(), part.data(), part.size())) > 0;) {
      all.insert(all.end(), part.begin(), part.begin() + n);
    }
    return all;
  }

 private:
  UniqueFd master_{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  std::string path_;
};

}  // namespace rc10::test
