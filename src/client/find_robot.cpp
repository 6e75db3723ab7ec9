#include "client/find_robot.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <vector>

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

}  // namespace

Result<RobotSocket> findRobot(const std::optional<std::string>& name) {
  if (name) {
    if (name->empty() || name->find('/') != std::string::npos) {
      return fail("'" + *name + "' is not the name of a robot: it is the `robot:` of the configuration");
    }
    return RobotSocket{*name, link::socketPath(*name)};
  }
  auto sockets = socketsIn(link::runDir());
  if (!sockets) return tl::unexpected(sockets.error());
  if (sockets->size() > 1) {
    sockets->erase(
        std::remove_if(sockets->begin(), sockets->end(), [](const auto& s) { return !listens(s); }),
        sockets->end());
  }
  if (sockets->empty()) {
    return fail("rc10d is not running (no socket in " + link::runDir() +
                "): start it with `rc10d -c FILE` or `systemctl start rc10d`");
  }
  if (sockets->size() == 1) return sockets->front();
  std::string names;
  for (const auto& socket : *sockets) names += (names.empty() ? "" : ", ") + socket.robot;
  return fail("several robots run here: " + names + "; choose one with --robot NAME");
}

}  // namespace rc10
