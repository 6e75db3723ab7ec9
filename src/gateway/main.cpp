#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

#include "app/standard_output.hpp"
#include "app/stderr_lines.hpp"
#include "client/find_robot.hpp"
#include "client/link_client.hpp"
#include "gateway/gateway.hpp"
#include "gateway/options.hpp"
#include "gateway/sandbox.hpp"
#include "gateway/udpm_url.hpp"
#include "rc10_version.hpp"

namespace {

using namespace rc10;

enum ExitCode : int { kOk = 0, kFailed = 1, kUsage = 2, kNoDaemon = 3 };

volatile std::sig_atomic_t stop_requested = 0;

int complain(const Error& error, ExitCode code) {
  std::fprintf(stderr, "rc10-lcm: %s\n", error.message.c_str());
  return code;
}

void catchSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = 1; };  // no SA_RESTART: it ends poll()
  // Those of a terminal, too: rc10d ends by them in order, and must find the gateway neither stopped nor
  // dumping.
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGTSTP}) ::sigaction(signal, &action, nullptr);
  // A line on stderr may meet a closed pipe, a file at its limit (ulimit -f), a terminal with `stty tostop`.
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGTTOU, SIGTTIN}) ::signal(signal, SIG_IGN);
}

Result<LinkClient> connect(const gateway::Options& options) {
  std::string path;
  if (options.socket) {
    path = *options.socket;
  } else {
    const auto robot = findRobot(options.robot);
    if (!robot) return tl::unexpected(robot.error());
    path = robot->path;
  }
  auto rc10d = LinkClient::connect(
      path, {.name = std::string(link::kGatewayClient),
             .subscriptions = link::kStates | link::kDiagnosticsFeed | link::kEvents | link::kModules});
  if (rc10d && options.robot && rc10d->welcome().robot.view() != *options.robot) {
    return fail("robot '" + std::string(rc10d->welcome().robot.view()) + "' answers at " + path + ", not '" +
                *options.robot + "'");
  }
  return rc10d;
}

Result<gateway::UdpmUrl> urlOf(const gateway::Options& options, const link::Welcome& welcome) {
  const std::string configured{welcome.lcm_url.view()};
  if (!options.url && configured.empty()) {
    return fail("LCM is off in the configuration of robot '" + std::string(welcome.robot.view()) +
                "': give --url URL");
  }
  return gateway::parseUdpmUrl(options.url.value_or(configured));
}

}  // namespace

int main(int argc, char** argv) {
  // The parent may have left CAN sockets open.
  (void)::close_range(STDERR_FILENO + 1, ~0U, 0);
  const auto options = gateway::parseOptions(argc, argv);
  if (!options) return complain(options.error(), kUsage);
  if (options->help || options->version) {
    std::fputs(options->help ? gateway::helpText() : (std::string("rc10-lcm ") + kVersion + "\n").c_str(),
               stdout);
    return statusOfOutput("rc10-lcm", kOk);
  }
  catchSignals();
  auto rc10d = connect(*options);
  if (!rc10d) return complain(rc10d.error(), kNoDaemon);
  const auto url = urlOf(*options, rc10d->welcome());
  if (!url) return complain(url.error(), kUsage);
  rc10d->prepareEstop();
  StderrLines lines;  // before /proc is closed
  if (const auto done = gateway::enterSandbox(rc10d->welcome().pid); !done)
    return complain(done.error(), kFailed);
  std::make_unique<gateway::Gateway>(std::move(*rc10d), *url, std::move(lines))->run(stop_requested);
  return kOk;
}
