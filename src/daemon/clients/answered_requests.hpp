#pragma once

#include <cstdint>
#include <deque>

#include "link/link_protocol.hpp"

namespace rc10 {

/// Whether it is the earlier request again: the same client, session, number and operation.
[[nodiscard]] bool repeats(const link::Request& request, const link::Request& earlier) noexcept;

/// Memory of the last answers, for requests that are repeated. `asker` is Speaker::owner(): an answer belongs
/// to its sender. Link thread only.
class AnsweredRequests {
 public:
  void remember(std::uint64_t asker, const link::Request& request, const link::Response& response);
  /// The newest answer to this request; null: there is none.
  [[nodiscard]] const link::Response* find(std::uint64_t asker, const link::Request& request) const;

 private:
  [[nodiscard]] std::uint64_t busiestAsker() const;
  void forgetOldest(std::uint64_t asker);

  struct Answered {
    std::uint64_t asker = 0;
    link::Text<32> operation;
    link::Response response;
  };
  std::deque<Answered> answered_;  // newest last; bounded
};

}  // namespace rc10
