#include "daemon/clients/answered_requests.hpp"

#include <algorithm>
#include <map>

namespace rc10 {
namespace {

// A program must not push out the answers of others, nor a user under many names those of other users.
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
  if (answered_.size() > kMaxRemembered) forgetOldest(busiestAsker());
}

std::uint64_t AnsweredRequests::busiestAsker() const {
  std::map<std::uint64_t, std::size_t> counts;
  for (const auto& each : answered_) ++counts[each.asker];
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

void AnsweredRequests::forgetOldest(std::uint64_t asker) {
  answered_.erase(std::find_if(answered_.begin(), answered_.end(),
                               [asker](const Answered& each) { return each.asker == asker; }));
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
