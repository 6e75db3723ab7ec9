#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/late_tick_causes.hpp"
#include "daemon/clients/link_socket.hpp"
#include "daemon/clients/publication.hpp"
#include "daemon/clients/request_desk.hpp"
#include "daemon/clients/signal_admission.hpp"
#include "daemon/clients/trace_desk.hpp"
#include "daemon/exchange/rings.hpp"
#include "link/link_message.hpp"

namespace rc10 {

/// The daemon's end of the link: clients in and out, between their sockets and the rings. Link thread
/// only. Nobody waits for it, and it waits for no client: what a client does not read is dropped, but answers
/// wait until they fill their room, and then the client is sent away.
class LinkServer {
 public:
  /// Parts of the daemon that the server reads. All outlive it.
  struct Sources {
    LinkExchange& exchange;
    std::span<const BusInbox> inboxes;
    const TickTiming& timing;
    const RobotDescription& robot;
    std::function<std::uint64_t()> page_faults;   ///< Of the real-time threads, after start.
    ThreadFacts tick_thread{};                    ///< Of the scheduler thread.
    std::function<void(const link::Event&)> log;  ///< Every event, for the log.
    std::function<void()> housekeeping;           ///< Called ten times a second: the watchdog.
  };

  [[nodiscard]] static Result<std::unique_ptr<LinkServer>> create(LinkSocket socket, Sources sources);

  void run(const std::stop_token& stop);
  /// One wait of at most `timeout_ms` and everything that is due after it.
  void poll(int timeout_ms);

 private:
  struct Connection {
    std::uint64_t id = 0;
    UniqueFd fd;
    link::Name client;
    std::uint32_t subscriptions = 0;
    bool welcomed = false;
    std::deque<link::Response> unsent{};  ///< Answers that found no room; the oldest first.
    Speaker speaker{};
    bool is_gateway = false;  ///< It says for whom it speaks.
  };

  LinkServer(LinkSocket socket, Sources sources, const Permissions& permissions, UniqueFd epoll,
             UniqueFd state_timer, UniqueFd slow_timer);

  void accept();
  [[nodiscard]] bool dropSilentConnection();
  void receive(std::size_t index);
  [[nodiscard]] bool handle(Connection& connection, std::span<const std::byte> datagram);
  /// A defective message may still be an e-stop. False.
  [[nodiscard]] bool obeyEstop(std::span<const std::byte> datagram, Connection& connection);
  [[nodiscard]] bool welcome(Connection& connection, std::span<const std::byte> datagram);
  [[nodiscard]] Speaker speakerOf(int fd, std::uint64_t connection) const;
  [[nodiscard]] Speaker speakerOf(const Connection& connection, const link::Name& client,
                                  link::Origin origin) const;
  void command(const link::Command& message, const Speaker& speaker);
  void signals(const link::Signals& message, const Speaker& speaker);
  void reportRefusal(CommandRefusal reason, const link::Name& client, const std::string& why = {});
  void tell(link::Event message);
  void request(const link::Request& message, Connection& connection);
  void chooseTrace(const link::TraceChoice& message, const Connection& connection);
  void close(std::size_t index);
  void answer(const RequestDesk::Answer& answer);
  void drainScheduler();
  void publishState();
  void publishModules(const Snapshot& snapshot);
  void recordAges(const Snapshot& snapshot);
  void publishDiagnostics();
  void publishTrace();
  void publish(std::uint32_t subscription, std::span<const std::byte> message);
  /// Hands an answer over, or keeps it.
  void respond(Connection& connection, link::Response response);
  /// Answers that have found no room until now; a client that leaves too many of them is sent away.
  void sendUnsent();
  void refuseForWantOfDescriptors();
  /// False: there was no room.
  static bool send(const Connection& connection, std::span<const std::byte> message) noexcept;

  LinkSocket socket_;
  Sources sources_;
  UniqueFd epoll_;
  UniqueFd state_timer_;
  UniqueFd slow_timer_;
  UniqueFd spare_;  ///< Given up for an instant to refuse a client when there are no descriptors left.
  MonotonicTime next_descriptor_report_{};
  Admission admission_;
  SignalAdmission signal_admission_;
  RequestDesk desk_;
  Publication publication_;
  LateTickCauses late_causes_;
  DurationHistogram state_ages_;  ///< Of the feedback in each state, when it is sent.
  TraceDesk trace_desk_;
  std::vector<Connection> connections_;
  std::uint64_t next_connection_ = 1;
  unsigned slow_ticks_ = 0;
  std::array<MonotonicTime, kCommandRefusalCount> next_refusal_report_{};
  std::array<std::byte, link::kMaxMessageSize> buffer_{};
  // One of each large message, filled in anew for every publication.
  link::State state_;
  link::Diagnostics diagnostics_;
  link::ModuleState module_state_;
  link::Trace trace_;
  link::Command command_;
  link::Signals signals_;
  Command accepted_;
  SignalMessage accepted_signals_;
};

}  // namespace rc10
