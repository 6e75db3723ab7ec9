#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "blackbox/places.hpp"
#include "client/file_request.hpp"
#include "link/run_dir.hpp"
#include "web/access.hpp"
#include "web/page_files.hpp"
#include "web/recordings.hpp"

namespace rc10::web {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8010;
  HostNames names;                   ///< Besides addresses and localhost.
  std::optional<std::string> robot;  ///< None: the only one of this computer.
  std::string token;                 ///< Token of pages on other computers; empty: there are none.
  Recordings recordings{link::runDir(), blackbox::stateDir()};
  std::string file_socket = client::kFileSocket;  ///< The root helper listens there.
};

/// HTTP and WebSocket for the page, in one thread: a bounded number of connections, each with bounded room.
class Server {
 public:
  static constexpr std::size_t kMaxConnections = 64;

  /// Listens. The error names the address and what to do.
  [[nodiscard]] static Result<std::unique_ptr<Server>> listen(const ServerOptions& options, PageFiles files);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Port 0 of the options is one that was free.
  [[nodiscard]] std::uint16_t port() const;
  /// Until SIGINT or SIGTERM.
  void run();

 private:
  class Parts;  // Beast's headers stay in one source
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace rc10::web
