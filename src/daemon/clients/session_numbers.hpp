#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace rc10 {

/// The last sequence number of each client's session. Each session counts for itself: of two programs with
/// one name, none makes the other's numbers old or new; which of them is obeyed, a lease decides. Link thread
/// only.
class SessionNumbers {
 public:
  enum class Verdict : std::uint8_t {
    kNew,
    kOld,        ///< Not above the last one of its session.
    kOfAnother,  ///< The session was begun by another owner.
  };
  [[nodiscard]] Verdict accept(std::uint64_t owner, std::string_view client, std::uint64_t session,
                               std::int64_t seq);

 private:
  struct Session {
    std::uint64_t owner = 0;
    std::int64_t last_seq = 0;
    std::uint64_t last_used = 0;  // counts messages
  };

  std::map<std::pair<std::string, std::uint64_t>, Session> sessions_;  // bounded
  std::uint64_t messages_ = 0;
};

}  // namespace rc10
