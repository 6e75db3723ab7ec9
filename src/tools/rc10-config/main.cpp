// rc10-config: one request about a robot's file, as root, started by rc10-config.socket for each connection.

#include <sys/socket.h>
#include <sys/time.h>

#include <cstdio>
#include <ctime>
#include <string>

#include <CLI/CLI.hpp>

#include "app/printable.hpp"
#include "client/file_request.hpp"
#include "program.hpp"
#include "rc10_version.hpp"
#include "robot_file/file_desk.hpp"
#include "robot_file/this_computer.hpp"

namespace {

using namespace rc10;

constexpr const char* kFolder = "/etc/rc10d";
constexpr int kSocket = STDIN_FILENO;

Result<robot_file::Caller> caller() {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(kSocket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0)
    return fail(
        "stdin is no connection: rc10-config.socket starts it, `sudo systemctl enable --now "
        "rc10-config.socket`");
  return robot_file::Caller{.process = link::ProcessIdentity::of(peer.pid), .user = peer.uid};
}

// The few seats of the socket are for those who ask.
Result<std::string> received() {
  const timeval patience{.tv_sec = 2, .tv_usec = 0};
  (void)::setsockopt(kSocket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  std::string bytes(client::FileRequest::kMostBytes + 1, '\0');
  const auto size = ::recv(kSocket, bytes.data(), bytes.size(), 0);
  if (size <= 0) return fail("nothing was asked within 2 s");
  bytes.resize(static_cast<std::size_t>(size));
  return bytes;
}

std::string logLine(const Result<client::FileRequest>& request, const robot_file::Caller& peer,
                    const client::FileAnswer& answer) {
  auto line = request ? std::string{toString(request->verb)} + " of robot '" + request->robot + "'"
                      : std::string{"request"};
  line += " by user " + std::to_string(peer.user) + ", process " + std::to_string(peer.process.pid);
  if (answer.done) return line + ": done";
  return line + ": refused: " + printable(answer.message.substr(0, answer.message.find('\n')));
}

int run(int argc, char** argv) {
  CLI::App app{
      "Checks and installs a robot's file and restarts rc10d, for one request on stdin, a connection",
      "rc10-config"};
  app.set_version_flag("--version", std::string{"rc10-config "} + kVersion);
  if (const auto status = parseCommandLine(app, argc, argv)) return *status;

  const auto peer = caller();
  if (!peer) {
    std::fprintf(stderr, "rc10-config: %s\n", peer.error().message.c_str());
    return kExitFailed;
  }
  const auto bytes = received();
  const auto request =
      bytes ? client::parseFileRequest(*bytes) : Result<client::FileRequest>{tl::unexpected(bytes.error())};
  const auto answer =
      request ? robot_file::answer(*request, *peer, kFolder, robot_file::thisComputer(), std::time(nullptr))
              : client::FileAnswer{.done = false, .message = request.error().message};
  std::fprintf(stderr, "%s\n", logLine(request, *peer, answer).c_str());
  const auto reply = bytesOf(answer);
  return ::send(kSocket, reply.data(), reply.size(), MSG_NOSIGNAL) < 0 ? kExitFailed : kExitOk;
}

}  // namespace

int main(int argc, char** argv) { return runProgram("rc10-config", run, argc, argv); }
