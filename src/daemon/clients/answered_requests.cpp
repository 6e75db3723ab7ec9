#include "daemon/clients/answered_requests.hpp"

#include <algorithm>

namespace rc10 {
namespace {

// A program must not push out the answers of others.
constexpr std::ptrdiff_t kMaxOfOne = 64;
constexpr std::size_t kMaxRemembered = 1024;

template <typename Other>
[[nodiscard]] bool sameNumber(const link::Request& request, const Other& other) noexcept {
  return request.session == other.session && request.seq == other.seq &&
         request.client.view() == other.client.view();
}

}  // namespace

bool repeats(const link::Request& request, const link::Request& earlier) noexcept {
  return sameNumber(request, earlier) && request.operation.view() == earlier.operation.view();
}

void AnsweredRequests::remember(std::uint64_t asker, const link::Request& request,
                                const link::Response& response) {
  answered_.push_back({asker, request.operation, response});
  const auto same = [&](const Answered& each) {
    return each.asker == asker && each.response.client.view() == response.client.view();
  };
  if (std::count_if(answered_.begin(), answered_.end(), same) > kMaxOfOne)
    answered_.erase(std::find_if(answered_.begin(), answered_.end(), same));
  if (answered_.size() > kMaxRemembered) answered_.pop_front();
}

const link::Response* AnsweredRequests::find(std::uint64_t asker, const link::Request& request) const {
  // The newest: a request that stops is answered anew each time.
  const auto found = std::find_if(answered_.rbegin(), answered_.rend(), [&](const Answered& each) {
    return each.asker == asker && sameNumber(request, each.response) &&
           each.operation.view() == request.operation.view();
  });
  return found == answered_.rend() ? nullptr : &found->response;
}

}  // namespace rc10
