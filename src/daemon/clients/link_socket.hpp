#pragma once

#include <string>

#include "app/result.hpp"
#include "app/unique_fd.hpp"

namespace rc10 {

/// The listening link socket, and the lock that makes this the only rc10d of its robot.
class LinkSocket {
 public:
  /// Creates `<dir>/<robot>.sock` and `<dir>/<robot>.estop`, and takes `<dir>/<robot>.lock`. The sockets may
  /// be used by the group rc10, if there is one. The error says who holds the lock or what is wrong with the
  /// folder.
  [[nodiscard]] static Result<LinkSocket> listen(const std::string& dir, const std::string& robot);

  LinkSocket(LinkSocket&&) noexcept = default;
  LinkSocket& operator=(LinkSocket&&) noexcept = default;
  LinkSocket(const LinkSocket&) = delete;
  LinkSocket& operator=(const LinkSocket&) = delete;
  ~LinkSocket();

  [[nodiscard]] int descriptor() const noexcept { return socket_.get(); }
  /// For EstopDatagrams.
  [[nodiscard]] int estopDescriptor() const noexcept { return estop_.get(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  LinkSocket() = default;

  UniqueFd lock_;
  UniqueFd socket_;
  UniqueFd estop_;
  std::string path_;
};

}  // namespace rc10
