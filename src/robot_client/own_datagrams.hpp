#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/unique_fd.hpp"

namespace rc10 {
inline namespace robot_client {

/// Datagrams of other computers, kept away from liblcm's sockets by filters in the kernel. LCM has no
/// passwords, and whatever the ttl, another computer reaches what liblcm receives with: version 1.3 by
/// unicast, all by the group where its route leaves the computer.
///
/// With ttl 0 what was sent on this computer comes in. With ttl ≥ 1 the network is meant: what comes to the
/// group by the interface of its route; but of a robot that was heard on this computer, nothing that another
/// computer says.
class OwnDatagrams {
 public:
  /// Before liblcm opens its sockets.
  OwnDatagrams();

  /// After that, and before anything is subscribed.
  void keepOut(const std::string& url);

  /// With ttl ≥ 1 a socket that becomes readable when this robot is heard on this computer; else none.
  [[nodiscard]] UniqueFd witnessOf(std::string_view robot) const;

  /// From here on nobody else speaks for this robot.
  void isHere(std::string_view robot);

 private:
  void filter() const;

  std::vector<int> before_;
  std::vector<int> sockets_;  ///< liblcm's own.
  std::string url_;
  std::vector<std::string> here_;  ///< Beginnings of channels: "host.v1.".
};

/// Whether LCM stays on this computer with this URL: udpm with ttl 0, which is LCM's default.
[[nodiscard]] bool staysOnThisComputer(const std::string& url);

}  // namespace robot_client
}  // namespace rc10
