#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "app/time.hpp"
#include "rc10/lcm_link.hpp"

namespace rc10 {
inline namespace robot_client {

/// A message and when it came, by this computer's clock. It may have waited before: where that matters, put
/// the time of the measurement into the message.
template <typename Message>
struct Received {
  Message message;
  MonotonicTime received;

  [[nodiscard]] Duration age() const noexcept { return std::chrono::steady_clock::now() - received; }
};

/// Receives messages of one LCM type on one channel: as a callback for each, as the latest with its age, or
/// both. Every member may be called from any thread.
template <typename Message>
class Subscriber {
 public:
  using Callback = std::function<void(const Message&)>;

  /// `callback` runs on the link's receiving thread: do not wait in it. It does not run any more once the
  /// destructor has returned.
  Subscriber(const LcmLink& link, const std::string& channel, Callback callback = {})
      : callback_(std::move(callback)),
        subscription_(link.subscribe(channel, [this](auto bytes) { receive(bytes); })) {}
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;
  ~Subscriber() { end(); }

  /// No callback from now on; allowed in the callback itself.
  void end() noexcept { subscription_.end(); }

  /// nullptr: none yet.
  [[nodiscard]] std::shared_ptr<const Received<Message>> latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
  }
  /// The next one after this call; nullptr: none within `timeout`. Not in a callback.
  [[nodiscard]] std::shared_ptr<const Received<Message>> waitForNext(Duration timeout) const {
    std::unique_lock lock(mutex_);
    const auto known = count_;
    if (!changed_.wait_for(lock, timeout, [&] { return count_ != known; })) return nullptr;
    return latest_;
  }

  /// Messages received.
  [[nodiscard]] std::uint64_t count() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }
  /// Messages of another type, or of other definitions of it, that came on this channel.
  [[nodiscard]] std::uint64_t foreign() const {
    const std::lock_guard lock(mutex_);
    return foreign_;
  }

 private:
  void receive(std::span<const std::byte> bytes) {
    auto received = std::make_shared<Received<Message>>();
    received->received = std::chrono::steady_clock::now();
    const bool ours = LcmLink::decode(bytes, received->message);
    {
      const std::lock_guard lock(mutex_);
      if (!ours) {
        ++foreign_;
        return;
      }
      latest_ = received;
      ++count_;
    }
    changed_.notify_all();
    if (callback_) callback_(received->message);
  }

  Callback callback_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::shared_ptr<const Received<Message>> latest_;
  std::uint64_t count_ = 0;
  std::uint64_t foreign_ = 0;
  Subscription subscription_;
};

}  // namespace robot_client
}  // namespace rc10
