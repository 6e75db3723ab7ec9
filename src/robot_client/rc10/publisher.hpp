#pragma once

#include <string>
#include <utility>

#include "app/result.hpp"
#include "rc10/lcm_link.hpp"

namespace rc10 {
inline namespace robot_client {

/// Sends messages of one LCM type on one channel. Any thread.
template <typename Message>
class Publisher {
 public:
  Publisher(const LcmLink& link, std::string channel) : link_(link), channel_(std::move(channel)) {}

  /// Does not wait for anybody. An error is local: nobody tells whether a message was received.
  Result<void> publish(const Message& message) const { return link_.publish(channel_, message); }

  [[nodiscard]] const std::string& channel() const noexcept { return channel_; }

 private:
  LcmLink link_;
  std::string channel_;
};

}  // namespace robot_client
}  // namespace rc10
