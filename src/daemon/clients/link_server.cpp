#include "daemon/clients/link_server.hpp"

#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

constexpr std::size_t kMaxConnections = 16;
constexpr int kMaxLinkEvents = 16;
// Taken from one client before the others have their turn.
constexpr int kDatagramsPerTurn = 32;
// Answers and events leave at this rate, whatever state_hz is.
constexpr int kSlowHz = 100;
// More than a client may have under way: it asks on and on, and reads nothing.
constexpr std::size_t kMaxUnsent = 128;
constexpr unsigned kDiagnosticsEvery = kSlowHz / 2;    // 2 Hz
constexpr unsigned kHousekeepingEvery = kSlowHz / 10;  // 10 Hz
constexpr unsigned kLateCausesEvery = kSlowHz / 50;    // 50 Hz, some ten ticks
// Refusals of one reason are told at most this often; all of them are counted.
constexpr Duration kRefusalReportInterval = std::chrono::seconds{1};
// epoll data: connections have their id, which starts at 1 and counts up.
constexpr std::uint64_t kListener = ~std::uint64_t{0};
constexpr std::uint64_t kStateTimer = kListener - 1;
constexpr std::uint64_t kSlowTimer = kListener - 2;

[[nodiscard]] UniqueFd makeTimer(int hz) noexcept {
  UniqueFd timer{timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)};
  const timespec period{.tv_sec = hz == 1 ? 1 : 0, .tv_nsec = hz == 1 ? 0 : 1'000'000'000 / hz};
  const itimerspec spec{.it_interval = period, .it_value = period};
  if (timer) timerfd_settime(timer.get(), 0, &spec, nullptr);
  return timer;
}

[[nodiscard]] bool watch(int epoll, int fd, std::uint64_t key) noexcept {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = key;
  return epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

[[nodiscard]] std::vector<KnownMotor> traits(const RobotDescription& robot) {
  std::vector<KnownMotor> out;
  out.reserve(robot.motors.size());
  for (const auto& motor : robot.motors) out.push_back({motor.name, motor.modes});
  return out;
}

[[nodiscard]] std::vector<KnownModule> modules(const RobotDescription& robot) {
  std::vector<KnownModule> out;
  out.reserve(robot.modules.size());
  for (const auto& module : robot.modules) out.push_back({module.name, module.signals.inputs});
  return out;
}

[[nodiscard]] std::vector<std::string> names(const RobotDescription& robot) {
  std::vector<std::string> out;
  out.reserve(robot.motors.size());
  for (const auto& motor : robot.motors) out.push_back(motor.name);
  return out;
}

[[nodiscard]] MotorSet optional(const RobotDescription& robot) {
  MotorSet out;
  for (std::size_t i = 0; i < robot.motors.size(); ++i) out.set(i, robot.motors[i].optional);
  return out;
}

[[nodiscard]] std::vector<const DriveSetup*> setups(const RobotDescription& robot) {
  std::vector<const DriveSetup*> out;
  out.reserve(robot.motors.size());
  for (const auto& motor : robot.motors) out.push_back(motor.setup);
  return out;
}

[[nodiscard]] std::vector<MotorLoops> loops(const RobotDescription& robot) {
  std::vector<MotorLoops> out;
  out.reserve(robot.motors.size());
  for (const auto& motor : robot.motors) out.push_back(motor.loops);
  return out;
}

[[nodiscard]] std::vector<std::optional<SimulatedDrive>> simulatedDrives(const RobotDescription& robot) {
  std::vector<std::optional<SimulatedDrive>> out;
  out.reserve(robot.motors.size());
  for (const auto& motor : robot.motors) out.push_back(motor.simulated);
  return out;
}

[[nodiscard]] Permissions::Rules rules(const RobotDescription& robot) {
  Permissions::Rules out{.clients = robot.clients,
                         .tuning_locked_at = robot.tuning_locked_at,
                         .clear_local_at = robot.clear_local_at,
                         .file = robot.config_file,
                         .motors = names(robot),
                         .modules = {}};
  for (const auto& module : robot.modules) out.modules.push_back(module.name);
  return out;
}

// Primary and supplementary. A process in more groups than these is known by its user and primary group.
[[nodiscard]] std::vector<gid_t> groupsOf(int fd, gid_t primary) {
  constexpr std::size_t kMaxGroups = 256;
  std::vector<gid_t> groups(kMaxGroups);
  socklen_t size = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  const bool known = ::getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) == 0;
  groups.resize(known ? size / sizeof(gid_t) : 0);
  groups.push_back(primary);
  return groups;
}

void drainTimer(int fd) noexcept {
  std::uint64_t expirations = 0;
  (void)!::read(fd, &expirations, sizeof expirations);
}

}  // namespace

LinkServer::LinkServer(LinkSocket socket, Sources sources, const Permissions& permissions, UniqueFd epoll,
                       UniqueFd state_timer, UniqueFd slow_timer)
    : socket_(std::move(socket)),
      sources_(std::move(sources)),
      epoll_(std::move(epoll)),
      state_timer_(std::move(state_timer)),
      slow_timer_(std::move(slow_timer)),
      spare_(::open("/dev/null", O_RDONLY | O_CLOEXEC)),
      admission_(traits(sources_.robot), permissions),
      signal_admission_(modules(sources_.robot), permissions),
      desk_(admission_, names(sources_.robot), optional(sources_.robot), setups(sources_.robot),
            loops(sources_.robot), simulatedDrives(sources_.robot)),
      publication_(sources_.robot),
      trace_desk_(sources_.robot, sources_.exchange.trace) {}

Result<std::unique_ptr<LinkServer>> LinkServer::create(LinkSocket socket, Sources sources) {
  auto permissions = Permissions::resolve(rules(sources.robot));
  if (!permissions) return tl::unexpected(permissions.error());
  UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
  UniqueFd state_timer = makeTimer(sources.robot.state_hz);
  UniqueFd slow_timer = makeTimer(kSlowHz);
  if (!epoll || !state_timer || !slow_timer) return fail(fmt::format("link: {}", std::strerror(errno)));
  if (!watch(epoll.get(), socket.descriptor(), kListener) ||
      !watch(epoll.get(), state_timer.get(), kStateTimer) ||
      !watch(epoll.get(), slow_timer.get(), kSlowTimer)) {
    return fail(fmt::format("link: epoll_ctl: {}", std::strerror(errno)));
  }
  return std::unique_ptr<LinkServer>(new LinkServer(std::move(socket), std::move(sources), *permissions,
                                                    std::move(epoll), std::move(state_timer),
                                                    std::move(slow_timer)));
}

void LinkServer::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) poll(100);
  drainScheduler();  // the last events and answers
}

void LinkServer::poll(int timeout_ms) {
  std::array<epoll_event, kMaxLinkEvents> events;
  const int count = epoll_wait(epoll_.get(), events.data(), kMaxLinkEvents, timeout_ms);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t key = events[static_cast<std::size_t>(i)].data.u64;
    if (key == kListener) {
      accept();
    } else if (key == kStateTimer) {
      drainTimer(state_timer_.get());
      publishState();
    } else if (key == kSlowTimer) {
      drainTimer(slow_timer_.get());
      drainScheduler();
      sendUnsent();
      publishTrace();
      if (slow_ticks_ % kLateCausesEvery == 0 && sources_.tick_thread.waited)
        late_causes_.update(sources_.timing.late, sources_.tick_thread);
      if (++slow_ticks_ % kHousekeepingEvery == 0 && sources_.housekeeping) sources_.housekeeping();
      if (slow_ticks_ % kDiagnosticsEvery == 0) publishDiagnostics();
    } else {
      // Looked up anew: an earlier event of this batch may have closed it.
      const auto found = std::find_if(connections_.begin(), connections_.end(),
                                      [key](const auto& c) { return c.id == key; });
      if (found != connections_.end()) receive(static_cast<std::size_t>(found - connections_.begin()));
    }
  }
}

void LinkServer::accept() {
  for (;;) {
    UniqueFd fd{::accept4(socket_.descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
    if (!fd && (errno == EMFILE || errno == ENFILE)) return refuseForWantOfDescriptors();
    if (!fd) return;
    if (connections_.size() >= kMaxConnections && !dropSilentConnection())
      continue;  // closed: the client sees it
    Connection connection;
    connection.id = next_connection_++;
    connection.speaker = speakerOf(fd.get(), connection.id);
    connection.fd = std::move(fd);
    if (watch(epoll_.get(), connection.fd.get(), connection.id))
      connections_.push_back(std::move(connection));
  }
}

// One that stayed in the queue would wake this thread again and again, and wait for ever.
void LinkServer::refuseForWantOfDescriptors() {
  spare_.reset();
  UniqueFd{::accept4(socket_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC)}.reset();
  spare_ = UniqueFd{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
  const auto now = monotonicNow();
  if (!sources_.log || now < next_descriptor_report_) return;
  next_descriptor_report_ = now + kRefusalReportInterval;
  link::Event event;
  event.severity = Severity::kError;
  event.source = std::string_view{"link"};
  event.text = std::string_view{
      "no file descriptors left: a client was sent away; raise the limit "
      "(LimitNOFILE= of the unit, `ulimit -n`)"};
  sources_.log(event);
}

Speaker LinkServer::speakerOf(int fd, std::uint64_t connection) const {
  ucred peer{.pid = 0, .uid = static_cast<uid_t>(-1), .gid = static_cast<gid_t>(-1)};
  socklen_t size = sizeof peer;
  (void)::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size);
  return {.connection = connection,
          .way = Speaker::Way::kSocket,
          .user = peer.uid,
          .grants = admission_.permissions().ofUser(peer.uid, groupsOf(fd, peer.gid))};
}

Speaker LinkServer::speakerOf(const Connection& connection, const link::Name& client,
                              link::Origin origin) const {
  if (!connection.is_gateway) return connection.speaker;
  const bool here = origin == link::Origin::kThisComputer;
  return {.connection = connection.id,
          .way = here ? Speaker::Way::kLcm : Speaker::Way::kNetwork,
          .user = connection.speaker.user,
          .grants = here ? admission_.permissions().ofLcmClient(client.view()) : GrantSet{}};
}

// Connections without a hello must not keep the others out.
bool LinkServer::dropSilentConnection() {
  const auto oldest =
      std::find_if(connections_.begin(), connections_.end(), [](const auto& c) { return !c.welcomed; });
  if (oldest == connections_.end()) return false;
  connections_.erase(oldest);  // it has asked for nothing yet
  return true;
}

void LinkServer::receive(std::size_t index) {
  for (int i = 0; i < kDatagramsPerTurn; ++i) {
    auto& connection = connections_[index];
    const auto size = ::recv(connection.fd.get(), buffer_.data(), buffer_.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    const bool fits = size > 0 && static_cast<std::size_t>(size) <= buffer_.size();
    if (!fits || !handle(connection, {buffer_.data(), static_cast<std::size_t>(size)})) {
      close(index);
      return;
    }
  }
}

// False: this client does not speak our protocol, and is sent away.
bool LinkServer::handle(Connection& connection, std::span<const std::byte> datagram) {
  link::Header header;
  if (!connection.welcomed) return link::readHeader(datagram, header) && welcome(connection, datagram);
  if (!link::readHeader(datagram, header)) return obeyEstop(datagram, connection);
  if (header.type == link::MessageType::kCommand) {
    if (link::open(datagram, command_)) {
      command(command_, speakerOf(connection, command_.client, command_.origin));
    } else {
      admission_.count(CommandRefusal::kMalformed);
      reportRefusal(CommandRefusal::kMalformed, connection.client);
    }
    return true;
  }
  if (header.type == link::MessageType::kSignals) {
    if (link::open(datagram, signals_)) {
      signals(signals_, speakerOf(connection, signals_.client, signals_.origin));
    } else {
      admission_.count(CommandRefusal::kMalformed);
      reportRefusal(CommandRefusal::kMalformed, connection.client);
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
    chooseTrace(message, connection);
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
  connection.subscriptions = hello.subscriptions;
  // The answer carries our version; a client of another version reads it there and says so.
  auto message = publication_.welcome();
  send(connection, link::seal(message));
  connection.welcomed = hello.protocol_version == link::kProtocolVersion;
  if (connection.welcomed && (connection.subscriptions & link::kModules) != 0) {
    for (std::size_t i = 0; i < sources_.robot.modules.size(); ++i) {
      auto info = publication_.moduleInfo(i);
      send(connection, link::seal(info));
    }
  }
  return connection.welcomed;
}

void LinkServer::command(const link::Command& message, const Speaker& speaker) {
  const auto refusal = admission_.admit(message, speaker, monotonicNow(), accepted_);
  const bool handed_over = refusal == CommandRefusal::kNone && sources_.exchange.commands.push(accepted_);
  const auto outcome = refusal == CommandRefusal::kNone && !handed_over ? CommandRefusal::kRingFull : refusal;
  admission_.count(outcome);
  if (outcome == CommandRefusal::kNotPermitted)
    return reportRefusal(outcome, message.client, admission_.whyNotPermitted());
  if (outcome != CommandRefusal::kNone) {
    const auto& culprit = admission_.culprit();
    return reportRefusal(outcome, message.client, culprit.empty() ? "" : culprit + ": " + describe(outcome));
  }
  if (!admission_.clearedField()) return;
  admission_.count(CommandRefusal::kUnusedField);
  reportRefusal(CommandRefusal::kUnusedField, message.client);
}

void LinkServer::signals(const link::Signals& message, const Speaker& speaker) {
  auto outcome = signal_admission_.admit(message, speaker, monotonicNow(), accepted_signals_);
  if (outcome == CommandRefusal::kNone && !sources_.exchange.signals.push(accepted_signals_))
    outcome = CommandRefusal::kRingFull;
  admission_.count(outcome);
  if (outcome == CommandRefusal::kNotPermitted)
    return reportRefusal(outcome, message.client, signal_admission_.whyNotPermitted());
  if (outcome != CommandRefusal::kNone) reportRefusal(outcome, message.client);
}

void LinkServer::reportRefusal(CommandRefusal reason, const link::Name& client, const std::string& why) {
  const auto now = monotonicNow();
  auto& next_report = next_refusal_report_[static_cast<std::size_t>(reason)];
  if (now < next_report) return;
  next_report = now + kRefusalReportInterval;
  // To clients not through the scheduler, which never saw the command; but it alone writes the black box.
  (void)sources_.exchange.refusals.push({EventCode::kCommandRefused, Severity::kWarning, -1,
                                         static_cast<std::int32_t>(reason), 0, now, client});
  tell(Publication::refusal(reason, client, now, wallClockUs(), why));
}

void LinkServer::tell(link::Event message) {
  publish(link::kEvents, link::seal(message));
  if (sources_.log) sources_.log(message);
}

void LinkServer::request(const link::Request& message, Connection& connection) {
  const auto speaker = speakerOf(connection, message.client, message.origin);
  auto outcome = desk_.begin(message, speaker);
  if (outcome.estop) {
    sources_.exchange.estop_client.slot() = message.client;
    sources_.exchange.estop_client.publish();
    sources_.exchange.estop.store(true, std::memory_order_release);
  }
  if (outcome.order && !sources_.exchange.orders.push(*outcome.order)) {
    if (const auto failed = desk_.fail(outcome.order->id, "the scheduler does not take orders"))
      answer(*failed);
  }
  if (outcome.hand) {
    auto& [order, response] = *outcome.hand;
    if (sources_.exchange.hands.push(order)) {
      desk_.handTaken(message, speaker, response);
    } else {
      response.status = link::ResponseStatus::kFailed;
      response.message = std::string_view{"hand: too many at once: the simulation is behind"};
    }
    respond(connection, response);
  }
  if (outcome.response) respond(connection, *outcome.response);
  if (outcome.not_permitted.empty()) return;
  admission_.count(CommandRefusal::kNotPermitted);
  reportRefusal(CommandRefusal::kNotPermitted, message.client, outcome.not_permitted);
}

void LinkServer::answer(const RequestDesk::Answer& answer) {
  for (auto& connection : connections_) {
    if (connection.id == answer.connection) respond(connection, answer.response);
  }
}

void LinkServer::respond(Connection& connection, link::Response response) {
  if (connection.unsent.empty() && send(connection, link::seal(response))) return;
  connection.unsent.push_back(std::move(response));
}

void LinkServer::sendUnsent() {
  for (std::size_t i = connections_.size(); i-- > 0;) {
    auto& unsent = connections_[i].unsent;
    while (!unsent.empty() && send(connections_[i], link::seal(unsent.front()))) unsent.pop_front();
    // It sees the end of the connection, and knows that answers are missing.
    if (unsent.size() > kMaxUnsent) close(i);
  }
}

void LinkServer::chooseTrace(const link::TraceChoice& message, const Connection& connection) {
  publishTrace();  // the last rows of the choice before
  trace_desk_.choose(connection.id, message);
  trace_desk_.fillChoice(trace_);
  send(connection, link::seal(trace_));
}

void LinkServer::publishTrace() {
  while (!trace_desk_.idle() && trace_desk_.fill(trace_)) {
    const auto message = link::seal(trace_);
    for (const auto& connection : connections_) {
      if (trace_desk_.isWatching(connection.id)) send(connection, message);
    }
  }
}

void LinkServer::close(std::size_t index) {
  trace_desk_.forget(connections_[index].id);
  connections_.erase(connections_.begin() +
                     static_cast<std::ptrdiff_t>(index));  // epoll forgets a closed descriptor
}

void LinkServer::drainScheduler() {
  OrderResult result;
  while (sources_.exchange.results.pop(result)) {
    if (const auto done = desk_.finish(result)) answer(*done);
  }
  Event event;
  while (sources_.exchange.events.pop(event)) {
    tell(publication_.event(event, wallClockUs()));
  }
  link::Event note;
  while (sources_.exchange.notes.pop(note)) tell(note);
  while (sources_.exchange.line_notes.pop(note)) tell(note);
}

void LinkServer::publishState() {
  if (!sources_.exchange.snapshot.everPublished()) return;  // a robot without motors would be a lie
  const auto& snapshot = sources_.exchange.snapshot.read();
  publication_.fill(state_, snapshot, wallClockUs());
  publish(link::kStates, link::seal(state_));
  recordAges(snapshot);
  publishModules(snapshot);
}

void LinkServer::recordAges(const Snapshot& snapshot) {
  const auto now = monotonicNow();
  for (std::size_t i = 0; i < snapshot.motor_count; ++i) {
    const auto& motor = snapshot.motors[i];
    if (motor.status != MotorStatus::kOffline && motor.feedback.samples > 0)
      state_ages_.record(now - motor.feedback.received);
  }
}

void LinkServer::publishModules(const Snapshot& snapshot) {
  for (std::size_t i = 0; i < snapshot.module_count; ++i) {
    publication_.fill(module_state_, i, snapshot, state_.utime);
    publish(link::kModules, link::seal(module_state_));
  }
}

void LinkServer::publishDiagnostics() {
  publication_.fill(diagnostics_, sources_.exchange.snapshot.read(),
                    {.timing = sources_.timing,
                     .ages = sources_.exchange.ages,
                     .state_ages = state_ages_,
                     .late = late_causes_,
                     .inboxes = sources_.inboxes,
                     .admission = admission_,
                     .page_faults = sources_.page_faults ? sources_.page_faults() : 0},
                    wallClockUs());
  publish(link::kDiagnosticsFeed, link::seal(diagnostics_));
}

void LinkServer::publish(std::uint32_t subscription, std::span<const std::byte> message) {
  for (const auto& connection : connections_) {
    if (connection.welcomed && (connection.subscriptions & subscription) != 0) send(connection, message);
  }
}

bool LinkServer::send(const Connection& connection, std::span<const std::byte> message) noexcept {
  // A client that does not read loses messages; the next state supersedes the lost one. One that is gone
  // needs none.
  return ::send(connection.fd.get(), message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 ||
         (errno != EAGAIN && errno != ENOBUFS);
}

}  // namespace rc10
