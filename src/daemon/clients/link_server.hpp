#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/connections.hpp"
#include "daemon/clients/disable_at_end.hpp"
#include "daemon/clients/feeds.hpp"
#include "daemon/clients/link_socket.hpp"
#include "daemon/clients/link_sources.hpp"
#include "daemon/clients/request_desk.hpp"
#include "daemon/clients/scan_desk.hpp"
#include "daemon/clients/signal_admission.hpp"
#include "link/link_message.hpp"

namespace rc10 {

/// The daemon's end of the link: clients in and out, between their sockets and the rings. Link thread
/// only. Nobody waits for it, and it waits for no client: what a client does not read is dropped, but answers
/// wait until they fill their room, and then the client is sent away.
class LinkServer {
 public:
  using Sources = LinkSources;

  [[nodiscard]] static Result<std::unique_ptr<LinkServer>> create(LinkSocket socket, Sources sources);

  void run(const std::stop_token& stop);
  /// One wait of at most `timeout_ms` and everything that is due after it.
  void poll(int timeout_ms);

 private:
  struct Timers {
    UniqueFd state;
    UniqueFd slow;
  };

  LinkServer(LinkSocket socket, Sources sources, const Permissions& permissions, UniqueFd epoll,
             Timers timers);

  void accept();
  void reportSentAway(std::string_view text);
  /// For the log alone.
  void note(Severity severity, std::string_view text);
  void receive(Connection& connection);
  [[nodiscard]] bool handle(Connection& connection, std::span<const std::byte> datagram);
  /// A defective message may still be an e-stop. False.
  [[nodiscard]] bool obeyEstop(std::span<const std::byte> datagram, Connection& connection);
  [[nodiscard]] bool welcome(Connection& connection, std::span<const std::byte> datagram);
  template <typename Push>
  [[nodiscard]] CommandRefusal passOn(CommandRefusal refusal, bool late, Push push);
  void command(const link::Command& message, const Speaker& speaker);
  void signals(const link::Signals& message, const Speaker& speaker);
  /// At most one of each reason a second; to the connection that is refused, one a second of any.
  void reportRefusal(CommandRefusal reason, std::uint64_t id, const link::Name& client,
                     const std::string& why = {});
  void request(const link::Request& message, Connection& connection);
  /// False: the request has its answer.
  bool handOver(const Order& order, const link::Request& message);
  void answer(const RequestDesk::Answer& answer);
  void drainScheduler();
  /// Clients whose connections have ended leave no motor enabled, no bus scanned, no gain that they only
  /// tried.
  void endForTheGone();
  void slowTick();
  void paceStates() noexcept;

  Sources sources_;
  UniqueFd epoll_;
  Timers timers_;
  MonotonicTime next_sent_away_report_{};
  Admission admission_;
  SignalAdmission signal_admission_;
  RequestDesk desk_;
  DisableAtEnd at_end_;
  ScanDesk scans_;
  Connections connections_;
  Feeds feeds_;
  unsigned slow_ticks_ = 0;
  bool states_wanted_ = false;
  std::array<MonotonicTime, kCommandRefusalCount> next_refusal_report_{};
  std::array<std::byte, link::kMaxMessageSize> buffer_{};
  link::Command command_;
  link::Signals signals_;
  Command accepted_;
  SignalMessage accepted_signals_;
};

}  // namespace rc10
