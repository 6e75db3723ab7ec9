#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "link/estop_datagram.hpp"
#include "link/link_message.hpp"

namespace rc10 {

/// A connection to a running rc10d. Nothing but connect() waits; not for several threads at once.
class LinkClient {
 public:
  struct Options {
    std::string_view name;            ///< Name of the client in rc10d's log and as the owner of motors.
    std::uint32_t subscriptions = 0;  ///< link::Subscription bits.
    std::string_view token = {};      ///< Token of an entry of `clients`.
    Duration timeout{std::chrono::seconds{1}};
  };

  enum class SendStatus : std::uint8_t {
    kSent,
    kBusy,    ///< rc10d does not read fast enough; the message is dropped.
    kClosed,  ///< rc10d has ended.
  };

  enum class ReceiveStatus : std::uint8_t { kMessage, kNothing, kClosed };
  struct Received {
    ReceiveStatus status = ReceiveStatus::kNothing;
    std::span<const std::byte> datagram;  ///< Inside the caller's buffer; for link::open().
  };

  /// Greets the rc10d that listens at `socket_path` and waits for its answer. The error says what the
  /// user can do.
  [[nodiscard]] static Result<LinkClient> connect(const std::string& socket_path, const Options& options);
  /// The same on a socket that is connected already; `socket_path` is for messages.
  [[nodiscard]] static Result<LinkClient> adopt(UniqueFd connected, const std::string& socket_path,
                                                const Options& options);

  LinkClient(LinkClient&&) = default;
  LinkClient& operator=(LinkClient&&) = default;
  LinkClient(const LinkClient&) = delete;
  LinkClient& operator=(const LinkClient&) = delete;

  /// The daemon's answer: the robot and its motors.
  [[nodiscard]] const link::Welcome& welcome() const noexcept { return *welcome_; }
  /// For poll(): readable when there is something to receive or rc10d has ended.
  [[nodiscard]] int descriptor() const noexcept { return socket_.get(); }

  /// A message whose received_ns is 0 is stamped with the present time.
  [[nodiscard]] SendStatus send(link::Command& command) noexcept;
  /// An e-stop goes by a datagram too, which the next tick takes however busy the rest of rc10d is.
  [[nodiscard]] SendStatus send(link::Request& request) noexcept;
  /// Opens the way of that datagram now and not when the first e-stop is sent: for a process that may open
  /// nothing later.
  void prepareEstop() noexcept;
  /// That datagram alone, for one whose own connection found no room. False: there is no way for it.
  [[nodiscard]] bool sendEstop(std::string_view client) noexcept { return estopWay().send(client); }
  [[nodiscard]] SendStatus send(link::Signals& signals) noexcept;
  [[nodiscard]] SendStatus send(link::TraceChoice& choice) noexcept;

  /// Does not wait. `buffer` has room for link::kMaxMessageSize.
  [[nodiscard]] Received receive(std::span<std::byte> buffer) noexcept;

 private:
  LinkClient(UniqueFd socket, std::string socket_path, std::unique_ptr<link::Welcome> welcome) noexcept
      : socket_(std::move(socket)), socket_path_(std::move(socket_path)), welcome_(std::move(welcome)) {}

  [[nodiscard]] const link::EstopDatagram& estopWay() noexcept;
  [[nodiscard]] SendStatus sendBytes(std::span<const std::byte> bytes) noexcept;

  UniqueFd socket_;
  std::string socket_path_;
  std::optional<link::EstopDatagram> estop_;
  std::unique_ptr<link::Welcome> welcome_;
};

}  // namespace rc10
