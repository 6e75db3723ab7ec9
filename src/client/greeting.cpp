#include "client/greeting.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <thread>
#include <vector>

#include "client/daemon_log.hpp"
#include "link/link_message.hpp"
#include "link/unix_address.hpp"

namespace rc10::client {
namespace {

using std::chrono::steady_clock;

constexpr auto kRetryPause = std::chrono::milliseconds{10};

// Waits for something to read. False: the deadline came first.
bool waitReadable(int socket, Deadline deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
    pollfd entry{.fd = socket, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

std::string silence(const std::string& robot) {
  return "rc10d for robot '" + robot +
         "' does not answer. Is it stopped, or the computer overloaded? See `systemctl status rc10d`";
}

std::string sentAway(const std::string& robot) {
  return "rc10d for robot '" + robot +
         "' closed the connection: it has too many clients, or has just ended; " + kSeeItsLog;
}

std::string otherVersion(const std::string& its_version) {
  return "rc10d " + its_version +
         " is of another build than this program: install both from the same one, then restart rc10d";
}

Result<std::unique_ptr<link::Welcome>> readWelcome(std::span<const std::byte> datagram) {
  auto welcome = std::make_unique<link::Welcome>();
  if (link::open(datagram, *welcome) && welcome->protocol_version == link::kProtocolVersion) return welcome;
  // The version comes first, so that it can be read even where the rest has changed.
  struct {
    link::Header header;
    std::uint32_t version = 0;
  } start;
  static_assert(offsetof(link::Welcome, protocol_version) == sizeof(link::Header));
  if (datagram.size() >= sizeof(start)) std::memcpy(&start, datagram.data(), sizeof(start));
  if (start.header.type != link::MessageType::kWelcome) return fail(otherVersion("(version unknown)"));
  return fail(otherVersion("(link version " + std::to_string(start.version) + ", not " +
                           std::to_string(link::kProtocolVersion) + ")"));
}

}  // namespace

std::string robotOf(const std::string& socket_path) {
  return std::filesystem::path(socket_path).stem().string();
}

std::string connectFailure(const std::string& socket_path, int error) {
  const std::string robot = robotOf(socket_path);
  const std::string not_running = "rc10d is not running for robot '" + robot + "' (";
  const std::string start = "): start it with `rc10d -c FILE` or `systemctl start rc10d`";
  switch (error) {
    case ENOENT:
    case ENOTDIR: return not_running + "no socket " + socket_path + start;
    case ECONNREFUSED: return not_running + "nobody listens at " + socket_path + start;
    case EACCES:
    case EPERM:
      return "no permission for " + socket_path +
             ": join its group with `sudo usermod -aG rc10 $USER`, then log in again";
    case EAGAIN: return silence(robot);
    case ENAMETOOLONG:
      return "the path " + socket_path + " is too long for a socket: use a shorter RC10_RUN_DIR";
    case EPROTOTYPE: return socket_path + " is not a socket of rc10d: another program made it";
    default:
      return "cannot connect to " + socket_path + ": " + std::strerror(error) + ": is rc10d well? " +
             kSeeItsLog;
  }
}

Result<UniqueFd> openSocket(const std::string& socket_path, Deadline deadline) {
  const auto address = link::unixAddress(socket_path);
  if (!address) return fail(connectFailure(socket_path, ENAMETOOLONG));
  // Non-blocking, since a listener whose queue is full would hold us for good.
  UniqueFd socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (!socket)
    return fail(std::string("cannot make a socket: ") + std::strerror(errno) +
                ": does this program, or the computer, have too many files open (`ulimit -n`)?");
  while (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
    const int error = errno;
    if (error != EINTR && error != EAGAIN) return fail(connectFailure(socket_path, error));
    if (steady_clock::now() >= deadline) return fail(connectFailure(socket_path, EAGAIN));
    std::this_thread::sleep_for(kRetryPause);
  }
  return socket;
}

Result<std::unique_ptr<link::Welcome>> greet(int socket, const std::string& socket_path, link::Hello hello,
                                             Deadline deadline) {
  const auto bytes = link::seal(hello);
  if (::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) {
    const bool closed = errno == EPIPE || errno == ECONNRESET;
    return fail(closed ? sentAway(robotOf(socket_path)) : connectFailure(socket_path, errno));
  }
  std::vector<std::byte> buffer(link::kMaxMessageSize);
  if (!waitReadable(socket, deadline)) return fail(silence(robotOf(socket_path)));
  const ssize_t size = ::recv(socket, buffer.data(), buffer.size(), MSG_TRUNC);
  if (size <= 0) return fail(sentAway(robotOf(socket_path)));
  return readWelcome(std::span{buffer}.first(std::min(buffer.size(), static_cast<std::size_t>(size))));
}

}  // namespace rc10::client
