#include "daemon/clients/connections.hpp"

#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include <fmt/format.h>

namespace rc10 {
namespace {

constexpr std::size_t kMaxConnections = 16;
// One more, which only rc10-lcm keeps: on it hangs all of LCM.
constexpr std::size_t kGatewaySeats = 1;
// A program that connects again and again leaves seats to others.
constexpr std::size_t kMostOfProcess = 12;
// More than a client may have under way: one with so many asks and never reads.
constexpr std::size_t kMaxUnsent = 128;
// Twice those of an e-stop of the largest robot. Of one that reads nothing for longer the oldest are dropped.
constexpr std::size_t kMaxWaitingEvents = 256;
// Publications lost in a row: with states at 100 Hz, a second after its socket is full. A slow client reads
// some of them.
constexpr unsigned kDeafAfter = 100;

[[nodiscard]] UniqueFd spareDescriptor() { return UniqueFd{::open("/dev/null", O_RDONLY | O_CLOEXEC)}; }

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

[[nodiscard]] ucred peerOf(int fd) noexcept {
  ucred peer{.pid = 0, .uid = static_cast<uid_t>(-1), .gid = static_cast<gid_t>(-1)};
  socklen_t size = sizeof peer;
  (void)::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size);
  return peer;
}

[[nodiscard]] std::string deafText(const Connection& connection) {
  const auto pid = connection.process;
  if (connection.is_gateway) {
    return fmt::format(
        "rc10-lcm (pid {0}) reads nothing: no state leaves over LCM, and an e-stop from there may not get "
        "in. If it does not go on, kill it (`kill -KILL {0}`): another one is started",
        pid);
  }
  return fmt::format(
      "client '{}' (pid {}) reads nothing, and loses its states and events: it is stopped or hangs",
      connection.client.view(), pid);
}

void reads(Connection& connection) noexcept {
  connection.lost_in_a_row = 0;
  connection.told_deaf = false;
}

}  // namespace

bool watchDescriptor(int epoll, int fd, std::uint64_t key) noexcept {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = key;
  return epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

Connections::Connections(LinkSocket socket, int epoll, const Permissions& permissions)
    : socket_(std::move(socket)), epoll_(epoll), permissions_(permissions), spare_(spareDescriptor()) {}

bool Connections::accept() {
  for (;;) {
    UniqueFd fd{::accept4(socket_.descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
    if (!fd && (errno == EMFILE || errno == ENFILE)) {
      refuseForWantOfDescriptors();
      return false;
    }
    if (!fd) return true;
    if (all_.size() >= kMaxConnections + kGatewaySeats && !dropSilent())
      continue;  // closed: the client sees it
    const auto peer = peerOf(fd.get());
    Connection connection;
    connection.id = next_id_++;
    connection.process = peer.pid;
    connection.speaker = speakerOf(fd.get(), peer, connection.id);
    connection.fd = std::move(fd);
    if (watchDescriptor(epoll_, connection.fd.get(), connection.id)) all_.push_back(std::move(connection));
  }
}

// One that stayed in the queue would wake this thread again and again, and wait for ever.
void Connections::refuseForWantOfDescriptors() {
  spare_.reset();
  UniqueFd{::accept4(socket_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC)}.reset();
  spare_ = spareDescriptor();
}

// Connections without a hello must not keep the others out.
bool Connections::dropSilent() {
  const auto oldest = std::find_if(all_.begin(), all_.end(), [](const auto& c) { return !c.welcomed; });
  if (oldest == all_.end()) return false;
  all_.erase(oldest);  // it has asked for nothing yet
  return true;
}

std::string Connections::whyNoSeat(const Connection& connection) const {
  if (connection.is_gateway) return {};
  std::size_t taken = 0;
  std::size_t of_process = 0;
  bool pages = connection.client.view() == link::kWebClient;
  for (const auto& other : all_) {
    if (!other.welcomed || other.is_gateway) continue;
    ++taken;
    if (other.process != connection.process) continue;
    ++of_process;
    pages = pages || other.client.view() == link::kWebClient;
  }
  if (taken >= kMaxConnections) return fmt::format("all {} seats are taken", kMaxConnections);
  if (of_process < kMostOfProcess || pages || connection.process == 0) return {};
  return fmt::format("its process (pid {}) has {} connections already: close those that it does not use",
                     connection.process, of_process);
}

Connection* Connections::find(std::uint64_t id) noexcept {
  const auto found = std::find_if(all_.begin(), all_.end(), [id](const auto& c) { return c.id == id; });
  return found != all_.end() ? &*found : nullptr;
}

// epoll forgets a closed descriptor.
void Connections::close(std::uint64_t id) {
  std::erase_if(all_, [id](const auto& connection) { return connection.id == id; });
}

Speaker Connections::speakerOf(int fd, const ucred& peer, std::uint64_t connection) const {
  return {.connection = connection,
          .way = Speaker::Way::kSocket,
          .user = peer.uid,
          .grants = permissions_.ofUser(peer.uid, groupsOf(fd, peer.gid))};
}

Speaker Connections::speakerOf(const Connection& connection, const link::Name& client,
                               link::Origin origin) const {
  if (!connection.is_gateway) return connection.speaker;
  const bool here = origin == link::Origin::kThisComputer;
  return {.connection = connection.id,
          .way = here ? Speaker::Way::kLcm : Speaker::Way::kNetwork,
          .user = connection.speaker.user,
          .grants = here ? permissions_.ofLcmClient(client.view()) : GrantSet{}};
}

bool Connections::send(const Connection& connection, std::span<const std::byte> message) noexcept {
  // A client that does not read loses messages; the next state supersedes the lost one. One that is gone
  // needs none.
  return ::send(connection.fd.get(), message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 ||
         (errno != EAGAIN && errno != ENOBUFS);
}

bool Connections::sendWaiting(Connection& connection) noexcept {
  auto& waiting = connection.waiting_events;
  while (!waiting.empty() && send(connection, waiting.front())) {
    waiting.pop_front();
    reads(connection);
  }
  return waiting.empty();
}

bool Connections::sendInOrder(Connection& connection, std::span<const std::byte> message) {
  return sendWaiting(connection) && send(connection, message);
}

bool Connections::tell(Connection& connection, std::span<const std::byte> event) {
  if (sendInOrder(connection, event)) return true;
  auto& waiting = connection.waiting_events;
  if (waiting.size() >= kMaxWaitingEvents) waiting.pop_front();
  waiting.emplace_back(event.begin(), event.end());
  return false;
}

void Connections::respond(Connection& connection, link::Response response) {
  if (connection.unsent.empty() && send(connection, link::seal(response))) return;
  connection.unsent.push_back(std::move(response));
}

bool Connections::wanted(std::uint32_t subscriptions) const noexcept {
  return std::any_of(all_.begin(), all_.end(), [subscriptions](const Connection& connection) {
    return connection.wants(subscriptions);
  });
}

void Connections::publish(std::uint32_t subscription, std::span<const std::byte> message) {
  for (auto& connection : all_) {
    if (!connection.wants(subscription)) continue;
    const bool sent =
        subscription == link::kEvents ? tell(connection, message) : sendInOrder(connection, message);
    if (sent)
      reads(connection);
    else
      ++connection.lost_in_a_row;
  }
}

std::vector<std::string> Connections::newlyDeaf() {
  std::vector<std::string> texts;
  for (auto& connection : all_) {
    if (connection.lost_in_a_row < kDeafAfter || connection.told_deaf) continue;
    texts.push_back(deafText(connection));
    connection.told_deaf = true;
  }
  return texts;
}

std::vector<std::uint64_t> Connections::sendUnsent() {
  std::vector<std::uint64_t> overfull;
  for (auto& connection : all_) {
    auto& unsent = connection.unsent;
    while (!unsent.empty() && send(connection, link::seal(unsent.front()))) unsent.pop_front();
    if (unsent.size() > kMaxUnsent) overfull.push_back(connection.id);
    (void)sendWaiting(connection);
  }
  for (const auto id : overfull) close(id);
  return overfull;
}

}  // namespace rc10
