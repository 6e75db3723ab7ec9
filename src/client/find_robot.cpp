#include "client/find_robot.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "app/nearest.hpp"
#include "app/printable.hpp"
#include "client/greeting.hpp"
#include "link/run_dir.hpp"

namespace rc10 {
namespace {

namespace fs = std::filesystem;

Result<std::vector<RobotSocket>> socketsIn(const std::string& dir) {
  std::vector<RobotSocket> found;
  std::error_code error;
  for (fs::directory_iterator entry(dir, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->path().extension() == ".sock" && entry->is_socket(ignored)) {
      found.push_back({entry->path().stem().string(), entry->path().string()});
    }
  }
  if (error == std::errc::permission_denied) return fail(client::connectFailure(dir, EACCES));
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.robot < b.robot; });
  return found;
}

// A daemon that was killed leaves its socket behind.
bool listens(const RobotSocket& socket) {
  const auto connection = client::openSocket(socket.path, std::chrono::steady_clock::now());
  return connection || connection.error().message != client::connectFailure(socket.path, ECONNREFUSED);
}

std::vector<RobotSocket> running(std::vector<RobotSocket> sockets) {
  sockets.erase(std::remove_if(sockets.begin(), sockets.end(), [](const auto& s) { return !listens(s); }),
                sockets.end());
  return sockets;
}

std::string namesOf(const std::vector<RobotSocket>& sockets) {
  std::string names;
  for (const auto& socket : sockets) names += (names.empty() ? "" : ", ") + socket.robot;
  return names;
}

/// "; robots that run here: hero, sentry; did you mean hero?"
std::string othersThan(const std::string& name) {
  const auto sockets = socketsIn(link::runDir());
  const auto others = sockets ? running(*sockets) : std::vector<RobotSocket>{};
  if (others.empty()) return {};
  std::vector<std::string_view> names;
  names.reserve(others.size());
  for (const auto& socket : others) names.emplace_back(socket.robot);
  return printable("; robots that run here: " + namesOf(others) + didYouMean(name, names));
}

Result<RobotSocket> named(const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos) {
    return fail("'" + name + "' is not the name of a robot: it is the `robot:` of the configuration");
  }
  RobotSocket socket{name, link::socketPath(name)};
  std::error_code unreadable;
  if (fs::exists(socket.path, unreadable) || unreadable) return socket;
  return fail(client::connectFailure(socket.path, ENOENT) + othersThan(name));
}

}  // namespace

Result<RobotSocket> findRobot(const std::optional<std::string>& name) {
  if (name) return named(*name);
  auto sockets = socketsIn(link::runDir());
  if (!sockets) return tl::unexpected(sockets.error());
  if (sockets->size() > 1) *sockets = running(std::move(*sockets));
  if (sockets->empty()) {
    return fail("rc10d is not running (no socket in " + link::runDir() +
                "): start it with `rc10d -c FILE` or `systemctl start rc10d`");
  }
  if (sockets->size() == 1) return sockets->front();
  return fail("several robots run here: " + namesOf(*sockets) + "; choose one with --robot NAME");
}

}  // namespace rc10
