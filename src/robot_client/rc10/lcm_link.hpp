#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

/// Keeps a handler subscribed as long as it lives. After its destructor the handler does not run any more; so
/// do not destroy it while holding a lock that the handler takes.
/// The handler and its captures are destroyed soon after, by the connection's thread.
class Subscription {
 public:
  Subscription() = default;
  Subscription(Subscription&&) = default;
  Subscription& operator=(Subscription&& other) noexcept;
  ~Subscription() { end(); }

  void end() noexcept;

 private:
  friend class LcmLink;
  struct Handler;
  explicit Subscription(std::shared_ptr<Handler> handler) : handler_(std::move(handler)) {}

  std::shared_ptr<Handler> handler_;
};

/// A connection to LCM with one thread that receives; copies are the same connection. Robots, publishers,
/// subscribers and services of a program share one.
///
/// Every member may be called from any thread. Handlers run on the receiving thread, one after the other: one
/// that waits holds up all the others. The last copy must not be destroyed in a handler.
class LcmLink {
 public:
  using Handler = std::function<void(std::span<const std::byte> message)>;

  /// `url`: an LCM provider; empty: $LCM_DEFAULT_URL, else LCM on this computer. Never throws: status() says
  /// whether it works.
  explicit LcmLink(const std::string& url = {});

  /// Reason why there is no LCM, and what to do about it.
  [[nodiscard]] Result<void> status() const;

  /// Sends without waiting for anybody. An error is local: nobody tells whether a message was received.
  Result<void> publish(const std::string& channel, std::span<const std::byte> message) const;

  /// The same for a type that lcm-gen has made.
  template <typename Message>
    requires requires(const Message& message) { message.getEncodedSize(); }
  Result<void> publish(const std::string& channel, const Message& message) const {
    return publish(channel, encoded(message));
  }

  /// Has `handler` called with every message on this channel; the name is taken literally. Messages that
  /// come faster than they are handled are dropped after the first hundred.
  [[nodiscard]] Subscription subscribe(const std::string& channel, Handler handler) const;

  /// For a handler: whether another message waits behind the one that it was called with.
  [[nodiscard]] bool moreWaits() const noexcept;
  /// For a handler: how long its message has waited since this computer received it, by the wall clock: in
  /// the socket, for another handler, or for the whole program, as after Ctrl-Z.
  [[nodiscard]] Duration waited() const noexcept;
  /// Whether the caller is a handler. It must not wait for messages, since none would come.
  [[nodiscard]] bool inHandler() const noexcept;

  template <typename Message>
  [[nodiscard]] static std::vector<std::byte> encoded(const Message& message) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    return bytes;
  }
  /// False: it is of another type, of other definitions, or cut off.
  template <typename Message>
  [[nodiscard]] static bool decode(std::span<const std::byte> bytes, Message& message) {
    return message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) >= 0;
  }

 private:
  friend class NamesHeard;
  /// Channels with one word between these.
  [[nodiscard]] Subscription subscribeBetween(const std::string& before, const std::string& after,
                                              std::function<void(const std::string& channel)> handler) const;

  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace robot_client
}  // namespace rc10
