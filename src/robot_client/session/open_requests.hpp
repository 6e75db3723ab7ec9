#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "rc10/request.hpp"
#include "rc10/response_t.hpp"

namespace rc10 {
inline namespace robot_client {

/// Requests that wait for their answers, by number. Pure.
class OpenRequests {
 public:
  void open(std::int64_t number) { answers_[number] = std::nullopt; }
  /// False: nobody waits for it, or it has come before.
  [[nodiscard]] bool take(response_t answer);
  [[nodiscard]] std::optional<response_t> answer(std::int64_t number) const;
  void close(std::int64_t number) { answers_.erase(number); }

 private:
  std::map<std::int64_t, std::optional<response_t>> answers_;
};

/// The answer to `operation`, as its caller gets it. `reasons`: those in its message.
[[nodiscard]] RequestResult requestResult(const std::string& operation, const response_t& answer,
                                          std::vector<MotorReason> reasons);

}  // namespace robot_client
}  // namespace rc10
