#include "web/server.hpp"

#include <chrono>
#include <csignal>
#include <deque>
#include <string_view>
#include <utility>
#include <variant>

// The headers of Asio and Beast are warned about as their own.
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "web/hub.hpp"

namespace rc10::web {
namespace serving {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::milliseconds kTurn{10};
constexpr std::chrono::seconds kRequestPatience{10};
constexpr std::uint32_t kMaxHeader = 8U << 10U;
// The text of a configuration, each byte of it escaped.
constexpr std::size_t kMaxMessage = 2 * CheckConfig::kMostBytes + 1024;
// A page that is so far behind gets no picture until it has read; one so far behind is given up.
constexpr std::size_t kBehindBytes = std::size_t{256} << 10U;
constexpr std::size_t kLostBytes = std::size_t{4} << 20U;
// All pages together; with more, each that is behind is given up. The unit has 64 MiB (MemoryMax).
constexpr std::size_t kMostWaiting = std::size_t{16} << 20U;
// Each way of a connection at the kernel, which doubles it (socket(7)) and would let it grow to 4 MiB: 16 MiB
// for 64 connections.
constexpr int kKernelBytes = 64 << 10;
// Memory of a waiting message beside its bytes.
constexpr std::size_t kMessageRoom = 128;
constexpr std::string_view kWebSocketPath = "/link";

// Nothing but this server's own files, and no frame of another page.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string_view viewOf(beast::string_view text) { return {text.data(), text.size()}; }

Caller callerOf(const http::request<http::empty_body>& request, bool loopback) {
  Caller caller{.host = viewOf(request[http::field::host]), .origin = {}, .loopback = loopback};
  if (const auto origin = request.find(http::field::origin); origin != request.end())
    caller.origin = viewOf(origin->value());
  return caller;
}

bool isLoopback(const tcp::socket& socket) {
  error_code error;
  const auto peer = socket.remote_endpoint(error);
  if (error) return false;
  const auto address = peer.address();
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).is_loopback();
  return address.is_loopback();
}

std::string addressOf(const tcp::socket& socket) {
  error_code error;
  const auto peer = socket.remote_endpoint(error);
  return error ? std::string{} : peer.address().to_string();
}

/// Shared by the connections of a server.
struct Shared {
  PageFiles files;
  HostNames names;
  Hub hub;
  std::size_t connections = 0;
  std::size_t waiting_bytes = 0;  ///< Room of all messages that were not sent yet.
};

/// One place among the connections, for as long as it lives.
class Place {
 public:
  explicit Place(Shared& shared) : shared_(&shared) { ++shared_->connections; }
  Place(Place&& other) noexcept : shared_(std::exchange(other.shared_, nullptr)) {}
  Place& operator=(Place&&) = delete;
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  ~Place() {
    if (shared_ != nullptr) --shared_->connections;
  }

 private:
  Shared* shared_;
};

/// An open page.
class PageConnection final : public PageSocket, public std::enable_shared_from_this<PageConnection> {
 public:
  PageConnection(tcp::socket socket, Shared& shared, Place place)
      : socket_(std::move(socket)), shared_(shared), place_(std::move(place)) {}
  PageConnection(const PageConnection&) = delete;
  PageConnection& operator=(const PageConnection&) = delete;
  ~PageConnection() override { shared_.waiting_bytes -= waiting_bytes_; }

  void accept(const http::request<http::empty_body>& request) {
    auto& tcp_socket = beast::get_lowest_layer(socket_).socket();
    loopback_ = isLoopback(tcp_socket);
    address_ = addressOf(tcp_socket);
    beast::get_lowest_layer(socket_).expires_never();
    socket_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    socket_.read_message_max(kMaxMessage);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->shared_.hub.join(*self, self->loopback_, self->address_);
      self->joined_ = true;
      self->read();
    });
  }

  void sendText(Text text) override { enqueue(std::move(text)); }
  void sendBinary(std::vector<std::byte> frame) override { enqueue(std::move(frame)); }
  [[nodiscard]] bool behind() const override { return waiting_bytes_ > kBehindBytes; }
  void close() override {
    closed_ = true;
    beast::get_lowest_layer(socket_).close();
  }

 private:
  using Message = std::variant<Text, std::vector<std::byte>>;

  static asio::const_buffer bytesOf(const Message& message) {
    if (const auto* text = std::get_if<Text>(&message)) return asio::buffer(**text);
    return asio::buffer(std::get<std::vector<std::byte>>(message));
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->end();
      const auto data = self->buffer_.data();
      self->shared_.hub.handle(*self, {static_cast<const char*>(data.data()), data.size()},
                               std::chrono::steady_clock::now());
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }

  static std::size_t roomOf(const Message& message) { return bytesOf(message).size() + kMessageRoom; }

  void enqueue(Message message) {
    if (closed_) return;
    waiting_bytes_ += roomOf(message);
    shared_.waiting_bytes += roomOf(message);
    queue_.push_back(std::move(message));
    const bool crowded = shared_.waiting_bytes > kMostWaiting;
    if (waiting_bytes_ > kLostBytes || (crowded && behind())) return close();
    if (queue_.size() == 1) write();
  }

  void write() {
    socket_.text(std::holds_alternative<Text>(queue_.front()));
    socket_.async_write(bytesOf(queue_.front()), [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->end();
      const auto sent = roomOf(self->queue_.front());
      self->waiting_bytes_ -= sent;
      self->shared_.waiting_bytes -= sent;
      self->queue_.pop_front();
      if (!self->queue_.empty()) self->write();
    });
  }

  void end() {
    if (std::exchange(joined_, false)) shared_.hub.leave(*this);
    close();
  }

  websocket::stream<beast::tcp_stream> socket_;
  Shared& shared_;
  Place place_;
  beast::flat_buffer buffer_;
  std::deque<Message> queue_;
  std::size_t waiting_bytes_ = 0;
  bool loopback_ = false;
  bool joined_ = false;
  bool closed_ = false;
  std::string address_;
};

/// A connection before it is a page's: it asks for files.
class FileConnection final : public std::enable_shared_from_this<FileConnection> {
 public:
  FileConnection(tcp::socket socket, Shared& shared)
      : stream_(std::move(socket)), shared_(shared), place_(shared) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    parser_->body_limit(0);
    stream_.expires_after(kRequestPatience);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->handle(self->parser_->release());
    });
  }

 private:
  void handle(const http::request<http::empty_body>& request) {
    const auto refused = refusal(callerOf(request, isLoopback(stream_.socket())), shared_.names);
    if (!refused.empty()) return answer(request, http::status::forbidden, refused);
    const auto path = viewOf(request.target()).substr(0, viewOf(request.target()).find('?'));
    if (websocket::is_upgrade(request) && path == kWebSocketPath) {
      std::make_shared<PageConnection>(stream_.release_socket(), shared_, std::move(place_))->accept(request);
      return;
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return answer(request, http::status::method_not_allowed, "files are only read here");
    const auto* file = shared_.files.find(path);
    if (file == nullptr) return answer(request, http::status::not_found, "there is no such file");
    answer(request, http::status::ok, file->bytes, file->type);
  }

  void answer(const http::request<http::empty_body>& request, http::status status, std::string_view body,
              std::string_view type = "text/plain; charset=utf-8") {
    response_ = {status, request.version()};
    response_.set(http::field::server, "rc10-web");  // rc10ctl web looks for it
    response_.set(http::field::content_type, beast::string_view{type.data(), type.size()});
    response_.set(http::field::cache_control, "no-cache");
    response_.set("Content-Security-Policy", beast::string_view{kPolicy.data(), kPolicy.size()});
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    // A browser honours it where nobody can change what comes (TLS, loopback), says so by this field, and
    // complains of it elsewhere.
    if (request.find("Sec-Fetch-Dest") != request.end())
      response_.set("Cross-Origin-Opener-Policy", "same-origin");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.keep_alive(request.keep_alive() && status == http::status::ok);
    response_.body() = body;
    response_.prepare_payload();
    if (request.method() == http::verb::head) response_.body().clear();
    stream_.expires_after(kRequestPatience);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      if (self->response_.keep_alive()) return self->read();
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  Shared& shared_;
  Place place_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
};

}  // namespace serving

using namespace serving;

class Server::Parts {
 public:
  Parts(const ServerOptions& options, PageFiles files)
      : shared_{.files = std::move(files),
                .names = options.names,
                .hub = Hub{options.robot, options.token, options.recordings, options.file_socket}},
        acceptor_(context_),
        signals_(context_, SIGINT, SIGTERM),
        timer_(context_) {}

  error_code listen(const std::string& address, std::uint16_t port) {
    error_code error;
    const tcp::endpoint endpoint{asio::ip::make_address(address, error), port};
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address{true}, error);
    // Inherited by what is accepted; before it listens, for the window is chosen then.
    if (!error) acceptor_.set_option(tcp::acceptor::send_buffer_size{kKernelBytes}, error);
    if (!error) acceptor_.set_option(tcp::acceptor::receive_buffer_size{kKernelBytes}, error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(tcp::acceptor::max_listen_connections, error);
    return error;
  }

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

  void run() {
    signals_.async_wait([this](error_code, int) { context_.stop(); });
    accept();
    turn(std::chrono::steady_clock::now());
    context_.run();
  }

 private:
  void accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      // Without room the connection is closed at once. Out of descriptors, too, the server goes on.
      if (!error && shared_.connections < kMaxConnections)
        std::make_shared<FileConnection>(std::move(socket), shared_)->read();
      if (error == asio::error::operation_aborted) return;
      if (error) {
        pause_.expires_after(kRetry);
        pause_.async_wait([this](error_code) { accept(); });
        return;
      }
      accept();
    });
  }

  void turn(std::chrono::steady_clock::time_point due) {
    timer_.expires_at(due);
    timer_.async_wait([this, due](error_code error) {
      if (error) return;
      shared_.hub.turn();
      if (shared_.hub.isTesting() && !testing_) runTests(std::chrono::steady_clock::now());
      // Turns that were missed are not made up for.
      turn(std::max(due + kTurn, std::chrono::steady_clock::now()));
    });
  }

  void runTests(std::chrono::steady_clock::time_point due) {
    testing_ = shared_.hub.isTesting();
    if (!testing_) return;
    test_timer_.expires_at(due);
    test_timer_.async_wait([this, due](error_code error) {
      if (error) return;
      const auto now = std::chrono::steady_clock::now();
      shared_.hub.runTests(now);
      runTests(std::max(due + client::MotionRun::kSendPeriod, now));
    });
  }

  static constexpr std::chrono::milliseconds kRetry{100};

  Shared shared_;  // outlives the connections that wait in the context
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::signal_set signals_;
  asio::steady_timer timer_;
  asio::steady_timer pause_{context_};
  asio::steady_timer test_timer_{context_};
  bool testing_ = false;
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::listen(const ServerOptions& options, PageFiles files) {
  auto parts = std::make_unique<Parts>(options, std::move(files));
  if (const auto error = parts->listen(options.address, options.port)) {
    return fail("cannot listen on " + options.address + ", port " + std::to_string(options.port) + ": " +
                error.message() + ". Choose others with --listen and --port");
  }
  return std::unique_ptr<Server>(new Server(std::move(parts)));
}

std::uint16_t Server::port() const { return parts_->port(); }
void Server::run() { parts_->run(); }

}  // namespace rc10::web
