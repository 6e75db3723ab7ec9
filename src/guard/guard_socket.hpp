#pragma once

#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10::guard {

/// Where rc10d finds its guard. Only processes of the same user, and root, are served.
class GuardSocket {
 public:
  /// Listens at link::guardSocketPath(), which only one guard may do. The error names the folder or says that
  /// there is a guard already.
  [[nodiscard]] static Result<GuardSocket> listen(const std::string& run_dir);

  GuardSocket(GuardSocket&&) noexcept = default;
  GuardSocket& operator=(GuardSocket&&) noexcept = default;
  GuardSocket(const GuardSocket&) = delete;
  GuardSocket& operator=(const GuardSocket&) = delete;
  ~GuardSocket();

  [[nodiscard]] int descriptor() const noexcept { return socket_.get(); }
  struct Accepted {
    UniqueFd connection;     ///< Connection of a process that may have a guard; empty: there is none.
    bool sent_away = false;  ///< A connection was closed for lack of file descriptors.
  };
  /// A connection that waits. Never waits itself.
  [[nodiscard]] Accepted accept() noexcept;

 private:
  GuardSocket() = default;

  UniqueFd lock_;
  UniqueFd socket_;
  UniqueFd spare_;  ///< Given up for an instant to send a visitor away when there are no descriptors left.
  std::string path_;
};

}  // namespace rc10::guard
