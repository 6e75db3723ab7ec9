#include "daemon/clients/link_server.hpp"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>

#include <fmt/format.h>

#include "app/errno_text.hpp"
#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

using namespace std::chrono_literals;

constexpr int kMaxLinkEvents = 16;
// Answers and events leave at this rate, whatever state_hz is.
constexpr int kSlowHz = 100;
// Without a listener a state is still computed: its rates are differences over a second.
constexpr int kUnwantedStateHz = 2;
constexpr unsigned kDiagnosticsEvery = kSlowHz / 2;    // 2 Hz
constexpr unsigned kHousekeepingEvery = kSlowHz / 10;  // 10 Hz
constexpr unsigned kLateCausesEvery = kSlowHz / 50;    // 50 Hz, twenty ticks at 1 kHz
// Refusals of one reason are told at most this often; all of them are counted.
constexpr Duration kRefusalReportInterval = std::chrono::seconds{1};
// epoll data: connections have their id, which starts at 1 and counts up.
constexpr std::uint64_t kListener = ~std::uint64_t{0};
constexpr std::uint64_t kStateTimer = kListener - 1;
constexpr std::uint64_t kSlowTimer = kListener - 2;

[[nodiscard]] constexpr timespec toTimespec(Duration time) noexcept {
  return {.tv_sec = time / 1s, .tv_nsec = (time % 1s) / 1ns};
}

// Expires at multiples of its period, so that two of one rate wake the thread once.
void setRate(int timer, int hz, MonotonicTime now) noexcept {
  const Duration period = Duration{1s} / hz;
  const auto next = (now.time_since_epoch() / period + 1) * period;
  const itimerspec spec{.it_interval = toTimespec(period), .it_value = toTimespec(next)};
  timerfd_settime(timer, TFD_TIMER_ABSTIME, &spec, nullptr);
}

[[nodiscard]] UniqueFd makeTimer(int hz, MonotonicTime now) noexcept {
  UniqueFd timer{timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)};
  if (timer) setRate(timer.get(), hz, now);
  return timer;
}

[[nodiscard]] Permissions::Rules rules(const RobotDescription& robot) {
  Permissions::Rules out{.clients = robot.clients,
                         .tuning_locked_at = robot.tuning_locked_at,
                         .clear_local_at = robot.clear_local_at,
                         .file = robot.config_file,
                         .motors = {},
                         .modules = {}};
  for (const auto& motor : robot.motors) out.motors.push_back(motor.name);
  for (const auto& module : robot.modules) out.modules.push_back(module.name);
  return out;
}

void drainTimer(int fd) noexcept {
  std::uint64_t expirations = 0;
  (void)!::read(fd, &expirations, sizeof expirations);
}

}  // namespace

LinkServer::LinkServer(LinkSocket socket, Sources sources, const Permissions& permissions, UniqueFd epoll,
                       Timers timers)
    : sources_(std::move(sources)),
      epoll_(std::move(epoll)),
      timers_(std::move(timers)),
      admission_(sources_.robot, permissions),
      signal_admission_(sources_.robot, permissions),
      desk_(admission_, sources_.robot),
      scans_(sources_.robot, sources_.exchange.scan),
      connections_(std::move(socket), epoll_.get(), admission_.permissions()),
      feeds_(sources_, connections_) {}

Result<std::unique_ptr<LinkServer>> LinkServer::create(LinkSocket socket, Sources sources) {
  auto permissions = Permissions::resolve(rules(sources.robot));
  if (!permissions) return tl::unexpected(permissions.error());
  UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
  const auto now = monotonicNow();
  Timers timers{.state = makeTimer(kUnwantedStateHz, now), .slow = makeTimer(kSlowHz, now)};
  if (!epoll || !timers.state || !timers.slow) return fail(fmt::format("link: {}", errnoText(errno)));
  if (!watchDescriptor(epoll.get(), socket.descriptor(), kListener) ||
      !watchDescriptor(epoll.get(), timers.state.get(), kStateTimer) ||
      !watchDescriptor(epoll.get(), timers.slow.get(), kSlowTimer)) {
    return fail(fmt::format("link: epoll_ctl: {}", errnoText(errno)));
  }
  return std::unique_ptr<LinkServer>(new LinkServer(std::move(socket), std::move(sources), *permissions,
                                                    std::move(epoll), std::move(timers)));
}

void LinkServer::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) poll(100);
  drainScheduler();  // the last events and answers
}

void LinkServer::poll(int timeout_ms) {
  std::array<epoll_event, kMaxLinkEvents> events;
  const int count = epoll_wait(epoll_.get(), events.data(), kMaxLinkEvents, timeout_ms);
  bool states_due = false;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t key = events[static_cast<std::size_t>(i)].data.u64;
    if (key == kListener) {
      accept();
    } else if (key == kStateTimer) {
      states_due = true;
    } else if (key == kSlowTimer) {
      drainTimer(timers_.slow.get());
      slowTick();
    } else if (auto* connection = connections_.find(key)) {
      // Looked up anew: an earlier event of this batch may have closed it.
      receive(*connection);
    }
  }
  // After the answers of this turn, so that the next state shows what they say.
  if (states_due) {
    drainTimer(timers_.state.get());
    feeds_.publishState();
  }
  paceStates();
}

// A timer that nobody waits for would wake this thread state_hz times a second.
void LinkServer::paceStates() noexcept {
  const bool wanted = feeds_.statesWanted();
  if (wanted == states_wanted_) return;
  states_wanted_ = wanted;
  setRate(timers_.state.get(), wanted ? sources_.robot.state_hz : kUnwantedStateHz, monotonicNow());
}

void LinkServer::slowTick() {
  drainScheduler();
  endForTheGone();
  scans_.sendOn(connections_);
  for (const auto id : connections_.sendUnsent()) feeds_.forget(id);
  for (const auto& text : connections_.newlyDeaf()) note(Severity::kWarning, text);
  feeds_.publishTrace();
  if (slow_ticks_ % kLateCausesEvery == 0) feeds_.countLateTicks();
  if (++slow_ticks_ % kHousekeepingEvery == 0 && sources_.housekeeping) sources_.housekeeping();
  if (slow_ticks_ % kDiagnosticsEvery == 0) feeds_.publishDiagnostics(admission_, desk_.gainsLeft());
}

// A full ring has room the next time.
void LinkServer::endForTheGone() {
  const auto is_open = [this](std::uint64_t id) { return connections_.find(id) != nullptr; };
  if (const auto order = at_end_.due(sources_.exchange.snapshot.read(), is_open);
      order && sources_.exchange.orders.push(*order))
    at_end_.taken(*order);
  if (const auto scan = desk_.scanForNobody(is_open))
    sources_.exchange.scan.given_up.store(*scan, std::memory_order_relaxed);
  if (const auto gains = desk_.gainsForNobody(is_open); gains && !sources_.exchange.orders.push(*gains))
    (void)desk_.fail(gains->id, "the scheduler does not take orders");
}

void LinkServer::accept() {
  if (connections_.accept()) return;
  reportSentAway(
      "no file descriptors left: a client was sent away; raise the limit "
      "(LimitNOFILE= of the unit, `ulimit -n`)");
}

void LinkServer::reportSentAway(std::string_view text) {
  const auto now = monotonicNow();
  if (now < next_sent_away_report_) return;
  next_sent_away_report_ = now + kRefusalReportInterval;
  note(Severity::kError, text);
}

void LinkServer::note(Severity severity, std::string_view text) {
  if (!sources_.log) return;
  link::Event event;
  event.severity = severity;
  event.source = std::string_view{"link"};
  event.text = text;
  sources_.log(event);
}

// One datagram: epoll tells of the next, and where there is none, as nearly always, a second look is a system
// call in vain.
void LinkServer::receive(Connection& connection) {
  const auto size = ::recv(connection.fd.get(), buffer_.data(), buffer_.size(), MSG_DONTWAIT | MSG_TRUNC);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  const bool fits = size > 0 && static_cast<std::size_t>(size) <= buffer_.size();
  if (fits && handle(connection, {buffer_.data(), static_cast<std::size_t>(size)})) return;
  feeds_.forget(connection.id);
  connections_.close(connection.id);
}

// False: this client does not speak our protocol, and is sent away.
bool LinkServer::handle(Connection& connection, std::span<const std::byte> datagram) {
  link::Header header;
  if (!connection.welcomed) return link::readHeader(datagram, header) && welcome(connection, datagram);
  if (!link::readHeader(datagram, header)) return obeyEstop(datagram, connection);
  if (header.type == link::MessageType::kCommand) {
    if (link::open(datagram, command_)) {
      command(command_, connections_.speakerOf(connection, command_.client, command_.origin));
    } else {
      admission_.count(CommandRefusal::kMalformed);
      reportRefusal(CommandRefusal::kMalformed, connection.id, connection.client);
    }
    return true;
  }
  if (header.type == link::MessageType::kSignals) {
    if (link::open(datagram, signals_)) {
      signals(signals_, connections_.speakerOf(connection, signals_.client, signals_.origin));
    } else {
      admission_.count(CommandRefusal::kMalformed);
      reportRefusal(CommandRefusal::kMalformed, connection.id, connection.client);
    }
    return true;
  }
  if (header.type == link::MessageType::kRequest) {
    link::Request message;
    if (!link::open(datagram, message)) return obeyEstop(datagram, connection);
    request(message, connection);
    return true;
  }
  if (header.type == link::MessageType::kTraceChoice) {
    link::TraceChoice message;
    if (!link::open(datagram, message)) return false;
    feeds_.chooseTrace(message, connection);
    return true;
  }
  return false;
}

// The client is sent away all the same: it does not speak our protocol.
bool LinkServer::obeyEstop(std::span<const std::byte> datagram, Connection& connection) {
  link::Request message;
  if (link::openEstop(datagram, message)) request(message, connection);
  return false;
}

bool LinkServer::welcome(Connection& connection, std::span<const std::byte> datagram) {
  link::Hello hello;
  if (!link::open(datagram, hello)) return false;
  connection.client = hello.client;
  // A process of rc10d's own user could end rc10d and start another: nobody is kept out by asking for more.
  connection.is_gateway =
      connection.speaker.user == ::geteuid() && hello.client.view() == link::kGatewayClient;
  if (const auto why = connections_.whyNoSeat(connection); !why.empty()) {
    reportSentAway(fmt::format("client '{}' was sent away: {}", hello.client.view(), why));
    return false;
  }
  connection.subscriptions = hello.subscriptions;
  if (const auto token = hello.token.view(); !token.empty() && !connection.is_gateway) {
    const auto granted = admission_.permissions().ofToken(token);
    connection.speaker.grants |= granted;
    connection.speaker.unknown_token = granted.none();
  }
  connection.welcomed = hello.protocol_version == link::kProtocolVersion;
  feeds_.greet(connection);
  return connection.welcomed;
}

// One that is late ends what its sender told before, and is counted by the scheduler.
template <typename Push>
CommandRefusal LinkServer::passOn(CommandRefusal refusal, bool late, Push push) {
  const bool handed_over = (refusal == CommandRefusal::kNone || late) && push();
  const auto outcome = refusal == CommandRefusal::kNone && !handed_over ? CommandRefusal::kRingFull : refusal;
  if (!late || !handed_over) admission_.count(outcome);
  return outcome;
}

void LinkServer::command(const link::Command& message, const Speaker& speaker) {
  const auto refusal = admission_.admit(message, speaker, monotonicNow(), accepted_);
  const auto outcome =
      passOn(refusal, admission_.lateButNew(), [this] { return sources_.exchange.commands.push(accepted_); });
  if (outcome == CommandRefusal::kNotPermitted)
    return reportRefusal(outcome, speaker.connection, message.client, admission_.whyNotPermitted());
  if (outcome != CommandRefusal::kNone) {
    const auto& culprit = admission_.culprit();
    return reportRefusal(outcome, speaker.connection, message.client,
                         culprit.empty() ? "" : culprit + ": " + describe(outcome) + admission_.choice());
  }
  if (!admission_.clearedField()) return;
  admission_.count(CommandRefusal::kUnusedField);
  reportRefusal(CommandRefusal::kUnusedField, speaker.connection, message.client);
}

void LinkServer::signals(const link::Signals& message, const Speaker& speaker) {
  const auto refusal = signal_admission_.admit(message, speaker, monotonicNow(), accepted_signals_);
  const auto outcome = passOn(refusal, signal_admission_.lateButNew(),
                              [this] { return sources_.exchange.signals.push(accepted_signals_); });
  if (outcome == CommandRefusal::kNotPermitted)
    return reportRefusal(outcome, speaker.connection, message.client, signal_admission_.whyNotPermitted());
  if (outcome != CommandRefusal::kNone) reportRefusal(outcome, speaker.connection, message.client);
}

void LinkServer::reportRefusal(CommandRefusal reason, std::uint64_t id, const link::Name& client,
                               const std::string& why) {
  const auto now = monotonicNow();
  auto& next_report = next_refusal_report_[static_cast<std::size_t>(reason)];
  auto* connection = connections_.find(id);
  const bool for_all = now >= next_report;
  // The one that is refused hears its reason, though others were refused for the same a moment ago.
  const bool for_it = connection != nullptr && now >= connection->next_refusal_report;
  if (!for_all && !for_it) return;
  if (connection != nullptr) connection->next_refusal_report = now + kRefusalReportInterval;
  auto event = Publication::refusal(reason, client, now, wallClockUs(), why);
  if (!for_all) {
    if (connection->wants(link::kEvents)) Connections::tell(*connection, link::seal(event));
    return;
  }
  next_report = now + kRefusalReportInterval;
  // Clients are told from here, since the scheduler never saw the command; it alone writes the black box.
  (void)sources_.exchange.refusals.push({EventCode::kCommandRefused, Severity::kWarning, -1,
                                         static_cast<std::int32_t>(reason), 0, now, client});
  feeds_.tell(event);
}

void LinkServer::request(const link::Request& message, Connection& connection) {
  const auto speaker = connections_.speakerOf(connection, message.client, message.origin);
  auto outcome = desk_.begin(message, speaker, monotonicNow());
  if (outcome.estop) {
    sources_.exchange.estop_client.slot() = message.client;
    sources_.exchange.estop_client.publish();
    sources_.exchange.estop.store(true, std::memory_order_release);
  }
  if (outcome.order && handOver(*outcome.order, message) && outcome.disable_at_end)
    at_end_.add(*outcome.order, connection.id);
  if (outcome.shaft) {
    auto& [order, response] = *outcome.shaft;
    if (sources_.exchange.shafts.push(order)) {
      desk_.shaftTaken(message, speaker, response);
    } else {
      response.status = link::ResponseStatus::kFailed;
      response.message = std::string_view{"too many requests at once: the simulation is behind"};
    }
    Connections::respond(connection, response);
  }
  if (outcome.response) Connections::respond(connection, *outcome.response);
  if (outcome.not_permitted.empty()) return;
  admission_.count(CommandRefusal::kNotPermitted);
  reportRefusal(CommandRefusal::kNotPermitted, connection.id, message.client, outcome.not_permitted);
}

bool LinkServer::handOver(const Order& order, const link::Request& message) {
  const bool first = order.operation != Operation::kScan || scans_.begin(order, message);
  if (first && sources_.exchange.orders.push(order)) return true;
  if (first) scans_.abandon(order.id);
  const auto* why = first ? "the scheduler does not take orders" : "scan: another scan goes on: wait for it";
  if (const auto failed = desk_.fail(order.id, why)) answer(*failed);
  return false;
}

void LinkServer::answer(const RequestDesk::Answer& answer) {
  if (auto* connection = connections_.find(answer.connection))
    Connections::respond(*connection, answer.response);
}

void LinkServer::drainScheduler() {
  OrderResult result;
  scans_.turn();
  while (sources_.exchange.results.pop(result)) {
    at_end_.finish(result, sources_.exchange.snapshot.read());
    auto report = scans_.end(result);
    const auto done = desk_.finish(result, report ? report->message : std::string{});
    if (!done) continue;
    if (!done->note.empty()) note(Severity::kError, done->note);
    if (report)
      scans_.deliver(done->connection, done->response, std::move(report->sightings));
    else
      answer(*done);
  }
  feeds_.publishEvents();
}

}  // namespace rc10
