#include <unistd.h>

#include <array>
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include "blackbox/places.hpp"
#include "client/page_token.hpp"
#include "client/recording_format.hpp"
#include "config/report/schema.hpp"
#include "config/report/template.hpp"
#include "link/run_dir.hpp"
#include "program.hpp"
#include "rc10_version.hpp"
#include "web/sandbox.hpp"
#include "web/server.hpp"
#include "web/token.hpp"

namespace {

using namespace rc10;

#ifndef RC10_PAGE_FOLDER
#define RC10_PAGE_FOLDER "/usr/share/rc10d/web"
#endif

int complain(const Error& error) {
  std::fprintf(stderr, "rc10-web: %s\n", error.message.c_str());
  return kExitFailed;
}

std::string hostName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string{name.data()} : std::string{};
}

int run(int argc, char** argv) {
  web::ServerOptions options;
  std::string page = RC10_PAGE_FOLDER;
  std::string token_file;
  CLI::App app{"The robot in a browser: serves the page, and is a client of rc10d", "rc10-web"};
  app.set_version_flag("--version", std::string{"rc10-web "} + kVersion);
  app.add_option("--robot", options.robot, "The robot; needed only if several run on this computer");
  app.add_option("--listen", options.address, "Address to listen on; another than 127.0.0.1 needs the token")
      ->capture_default_str();
  app.add_option("--port", options.port, "0: one that is free")->capture_default_str();
  app.add_option("--name", options.names, "A name that the page is opened by, besides this computer's");
  app.add_option("--page", page, "Folder of the page")->capture_default_str();
  app.add_option("--token-file", token_file, "File of the token; default: web-token in rc10d's run folder");
  app.add_option("--config-socket", options.file_socket, "Socket of the root helper")->capture_default_str();
  if (const auto status = parseCommandLine(app, argc, argv)) return *status;

  const auto host = hostName();
  if (!host.empty()) {
    options.names.push_back(host);
    options.names.push_back(host + ".local");
  }
  const bool others = options.address != "127.0.0.1" && options.address != "::1";
  if (others) {
    auto token = web::readOrMakeToken(token_file.empty() ? client::pageTokenPath() : token_file);
    if (!token) return complain(token.error());
    options.token = std::move(*token);
  }
  auto files = web::PageFiles::read(page);
  if (!files) return complain(files.error());
  files->add("/recording-format.json", {client::recordingFormatJson(), "application/json"});
  files->add("/rc10d.schema.json", {configSchema(), "application/json"});
  files->add("/template.yaml", {std::string{configTemplate()}, "text/plain; charset=utf-8"});
  auto server = web::Server::listen(options, std::move(*files));
  if (!server) return complain(server.error());
  if (const auto done = web::enterSandbox({link::runDir(), blackbox::stateDir()}); !done)
    return complain(done.error());
  std::printf("rc10-web: http://%s:%u/%s%s\n", others ? host.c_str() : "localhost", (*server)->port(),
              others ? "#" : "", options.token.c_str());
  std::fflush(stdout);
  (*server)->run();
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) { return runProgram("rc10-web", run, argc, argv); }
