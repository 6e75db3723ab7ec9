#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/json_line.hpp"
#include "client/page_token.hpp"
#include "config/sha256.hpp"
#include "page_addresses.hpp"
#include "qr_picture.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

// As systemd/rc10-web.service has it.
constexpr const char* kServiceToken = "/run/rc10-web/token";

struct Options {
  std::uint16_t port = 8010;
  std::optional<std::string> token_file;
  bool new_token = false;
};

// That of the service, which is there while it runs; else that of an rc10-web by hand, which RC10_RUN_DIR
// means.
Result<std::string> token(const Options& options) {
  const bool by_hand = std::getenv("RC10_RUN_DIR") != nullptr;
  std::string path = options.token_file.value_or(by_hand ? client::pageTokenPath() : kServiceToken);
  auto found = client::readPageToken(path);
  if (found && !*found && !options.token_file && !by_hand) {
    path = client::pageTokenPath();
    found = client::readPageToken(path);
  }
  if (!found && ::geteuid() != 0 && ::access(path.c_str(), R_OK) != 0)
    return fail(path + ", the token of other computers, is for its owner alone: `sudo rc10ctl web`");
  if (!found) return tl::unexpected(found.error());
  auto& token = *found;
  if (!token)
    return fail("there is no token in " + path + ": name the file that rc10-web has, with --token-file");
  return std::move(*token);
}

void showCode(const std::string& url) {
  if (!utf8()) return;
  const auto picture = qrPicture(url, coloured(STDOUT_FILENO));
  const auto screen = screenSize(STDOUT_FILENO);
  if (!picture) {
    std::printf("No QR code: %s.\n", picture.error().message.c_str());
    return;
  }
  if (screen.columns != 0 && screen.columns < picture->columns) {
    std::printf("The terminal is too narrow for the QR code: %zu columns.\n", picture->columns);
    return;
  }
  std::fputs(picture->lines.c_str(), stdout);
}

// For the robot's file and for a person; it is written nowhere.
ExitCode newToken(const Global& global, const Options& options) {
  const auto token = client::makePageToken();
  if (!token) return complain(token.error(), ExitCode::kFailed);
  const auto url = "http://localhost:" + std::to_string(options.port) + "/#" + *token;
  const auto hash = sha256(*token);
  if (global.json) {
    std::puts(client::lineOf({{"url", url}, {"sha256", hash}}).c_str());
  } else {
    std::printf("for clients in the robot's file:  - {token: %s, may: [command]}\n", hash.c_str());
    std::printf("the page with these rights:       %s\n", url.c_str());
  }
  return ExitCode::kOk;
}

ExitCode web(const Global& global, const Options& options) {
  const auto found = findPage(options.port);
  const auto port = std::to_string(options.port);
  if (!found.here && found.others.empty()) {
    return complain({"rc10-web does not answer on port " + port +
                     ": `sudo systemctl start rc10-web`, or `rc10-web`; another port with --port"},
                    ExitCode::kFailed);
  }
  std::vector<std::string> urls;
  std::optional<Error> no_token;
  if (!found.others.empty()) {
    const auto shown = token(options);
    if (!shown) no_token = shown.error();
    for (const auto& address : found.others) {
      if (!shown) continue;
      auto& url = urls.emplace_back("http://");
      url.append(address).append(":").append(port).append("/#").append(*shown);
    }
  }
  const auto here = found.here ? "http://localhost:" + port + "/" : std::string{};
  if (global.json && !no_token) {
    std::puts(client::lineOf(
                  {{"here", here.empty() ? client::Json(nullptr) : client::Json(here)}, {"others", urls}})
                  .c_str());
    return ExitCode::kOk;
  }
  if (!global.json && !here.empty()) std::printf("on this computer: %s\n", here.c_str());
  if (no_token) return complain(*no_token, ExitCode::kFailed);
  for (const auto& url : urls) std::printf("on others: %s\n", url.c_str());
  if (urls.empty())
    std::puts("Other computers are not served: docs/studio.md, \"Who may do what\".");
  else
    showCode(urls.front());
  return ExitCode::kOk;
}

}  // namespace

void addWeb(CLI::App& app, Action& action) {
  const auto options = std::make_shared<Options>();
  auto* verb = app.add_subcommand("web", "the address of the robot's page, as a QR code too");
  verb->add_option("--port", options->port, "that of rc10-web")->type_name("N")->capture_default_str();
  verb->add_option("--token-file", options->token_file, "that of rc10-web")->type_name("FILE");
  verb->add_flag("--new-token", options->new_token, "makes a token for an entry of `clients`");
  verb->callback([&action, options] {
    action = [options](const Global& global) {
      return options->new_token ? newToken(global, *options) : web(global, *options);
    };
  });
}

}  // namespace rc10::ctl
