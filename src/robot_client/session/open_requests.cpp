#include "robot_client/session/open_requests.hpp"

namespace rc10 {
inline namespace robot_client {

bool OpenRequests::take(response_t answer) {
  const auto found = answers_.find(answer.seq);
  if (found == answers_.end() || found->second) return false;
  found->second = std::move(answer);
  return true;
}

std::optional<response_t> OpenRequests::answer(std::int64_t number) const {
  const auto found = answers_.find(number);
  return found == answers_.end() ? std::nullopt : found->second;
}

RequestResult requestResult(const std::string& operation, const response_t& answer,
                            std::vector<MotorReason> reasons) {
  if (answer.status != response_t::STATUS_OK) {
    const bool refused = answer.status == response_t::STATUS_REFUSED;
    return tl::unexpected(RequestError{refused ? RequestError::Kind::kRefused : RequestError::Kind::kFailed,
                                       operation + (refused ? " refused: " : " failed: ") + answer.message,
                                       std::move(reasons)});
  }
  Response response{answer.message, std::move(reasons), {}};
  for (const auto& value : answer.values) response.values[value.name] = value.value;
  return response;
}

}  // namespace robot_client
}  // namespace rc10
