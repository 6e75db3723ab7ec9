#pragma once

#include <string>
#include <vector>

namespace rc10 {
inline namespace robot_client {

/// Whatever the ttl, another computer reaches what liblcm receives with: version 1.3 by unicast, all by the
/// group where its route leaves the computer. This finds the sockets that liblcm opens, and lets in what was
/// sent on this computer.
class OwnDatagrams {
 public:
  /// Before liblcm opens its sockets.
  OwnDatagrams();

  /// After that, and before anything is subscribed. With ttl ≥ 1 in the URL the network is meant, and all
  /// comes in.
  void keepOut(const std::string& url) const;

 private:
  std::vector<int> before_;
};

/// Whether LCM stays on this computer with this URL: udpm with ttl 0, which is LCM's default.
[[nodiscard]] bool staysOnThisComputer(const std::string& url);

}  // namespace robot_client
}  // namespace rc10
