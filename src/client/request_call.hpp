#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "client/link_client.hpp"

namespace rc10 {

/// A number that no other run of a program uses, for Command::session and Request::session.
[[nodiscard]] std::uint64_t randomSession();

/// Requests, one after the other, each with its answer.
class RequestCall {
 public:
  /// `connection` must outlive this.
  explicit RequestCall(LinkClient& connection, std::string_view client_name);

  /// A message that is not the answer.
  using Other = std::function<void(std::span<const std::byte> datagram)>;

  /// Sends the request under this run's session and the next number, and waits for its answer, or until
  /// `given_up`. Other messages that come meanwhile go to `other`, or are dropped: use a connection without
  /// subscriptions. The error is for a connection that gave none; a refusal is a response.
  [[nodiscard]] Result<link::Response> call(link::Request request, Duration timeout = std::chrono::seconds{5},
                                            const Other& other = {}, bool (*given_up)() noexcept = nullptr);

 private:
  [[nodiscard]] bool answers(std::span<const std::byte> datagram, link::Response& response) const noexcept;

  LinkClient& connection_;
  link::Name client_;
  std::uint64_t session_;
  std::int64_t seq_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace rc10
