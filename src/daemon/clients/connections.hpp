#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "daemon/clients/link_socket.hpp"
#include "daemon/clients/permissions.hpp"
#include "link/link_message.hpp"

namespace rc10 {

/// A client of the link.
struct Connection {
  std::uint64_t id = 0;  ///< Starts at 1 and counts up.
  UniqueFd fd;
  pid_t process = 0;  ///< 0: of a pid namespace that this one does not see.
  link::Name client;
  std::uint32_t subscriptions = 0;
  bool welcomed = false;
  std::deque<link::Response> unsent{};                  ///< Answers that found no room; the oldest first.
  std::deque<std::vector<std::byte>> waiting_events{};  ///< Events that found none.
  Speaker speaker{};
  bool is_gateway = false;     ///< It says for whom it speaks.
  unsigned lost_in_a_row = 0;  ///< Publications that found no room, since the last that did.
  bool told_deaf = false;      ///< newlyDeaf() has named it.
  MonotonicTime next_refusal_report{};

  [[nodiscard]] bool wants(std::uint32_t subscription) const noexcept {
    return welcomed && (subscriptions & subscription) != 0;
  }
};

/// Makes epoll report `key` when there is something to read.
[[nodiscard]] bool watchDescriptor(int epoll, int fd, std::uint64_t key) noexcept;

/// Clients' connections, and what is sent to them: what a client does not read is dropped, but answers and
/// events wait until they fill their room, and nothing that is published overtakes an event: a state that is
/// younger than a stop is read after it. Link thread only.
class Connections {
 public:
  /// epoll reports what a client sends by the id of its connection.
  Connections(LinkSocket socket, int epoll, const Permissions& permissions);

  /// Takes those that wait. False: one was sent away, since there are no descriptors left.
  [[nodiscard]] bool accept();
  /// The reason why there is no room for one that says hello; empty: there is. For rc10-lcm there always is.
  [[nodiscard]] std::string whyNoSeat(const Connection& connection) const;
  /// Null: it has been closed.
  [[nodiscard]] Connection* find(std::uint64_t id) noexcept;
  void close(std::uint64_t id);

  /// Sender of a message that came over this connection.
  [[nodiscard]] Speaker speakerOf(const Connection& connection, const link::Name& client,
                                  link::Origin origin) const;

  /// False: there was no room.
  static bool send(const Connection& connection, std::span<const std::byte> message) noexcept;
  /// The same after the events that wait.
  static bool sendInOrder(Connection& connection, std::span<const std::byte> message);
  /// Sends an event, or keeps it.
  static bool tell(Connection& connection, std::span<const std::byte> event);
  /// Hands an answer over, or keeps it.
  static void respond(Connection& connection, link::Response response);
  /// Somebody subscribed to one of these.
  [[nodiscard]] bool wanted(std::uint32_t subscriptions) const noexcept;
  /// To all that subscribed.
  void publish(std::uint32_t subscription, std::span<const std::byte> message);
  /// Answers and events that have found no room until now. Returns the clients that have left too many of
  /// them: each sees the end of its connection, and knows that answers are missing.
  [[nodiscard]] std::vector<std::uint64_t> sendUnsent();
  /// Text for each client that has begun to lose all that it subscribed to: it stands still. Once, until it
  /// reads again.
  [[nodiscard]] std::vector<std::string> newlyDeaf();

  [[nodiscard]] std::vector<Connection>& all() noexcept { return all_; }
  [[nodiscard]] const std::vector<Connection>& all() const noexcept { return all_; }

 private:
  [[nodiscard]] bool dropSilent();
  /// Whether no event waits any more.
  static bool sendWaiting(Connection& connection) noexcept;
  void refuseForWantOfDescriptors();
  [[nodiscard]] Speaker speakerOf(int fd, const ucred& peer, std::uint64_t connection) const;

  LinkSocket socket_;
  int epoll_;
  const Permissions& permissions_;
  UniqueFd spare_;  ///< Given up for an instant to refuse a client when there are no descriptors left.
  std::vector<Connection> all_;
  std::uint64_t next_id_ = 1;
};

}  // namespace rc10
