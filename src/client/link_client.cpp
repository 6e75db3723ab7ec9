#include "client/link_client.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

#include "client/greeting.hpp"

namespace rc10 {
namespace {

std::int64_t nowNs() noexcept {
  return Duration{std::chrono::steady_clock::now().time_since_epoch()}.count();
}

}  // namespace

Result<LinkClient> LinkClient::connect(const std::string& socket_path, const Options& options) {
  auto socket = client::openSocket(socket_path, std::chrono::steady_clock::now() + options.timeout);
  if (!socket) return tl::unexpected(socket.error());
  return adopt(std::move(*socket), socket_path, options);
}

Result<LinkClient> LinkClient::adopt(UniqueFd connected, const std::string& socket_path,
                                     const Options& options) {
  const auto deadline = std::chrono::steady_clock::now() + options.timeout;
  link::Hello hello;
  hello.subscriptions = options.subscriptions;
  hello.client = options.name;
  hello.token = options.token;
  auto welcome = client::greet(connected.get(), socket_path, hello, deadline);
  if (!welcome) return tl::unexpected(welcome.error());
  return LinkClient{std::move(connected), socket_path, std::move(*welcome)};
}

LinkClient::SendStatus LinkClient::send(link::Command& command) noexcept {
  if (command.received_ns == 0) command.received_ns = nowNs();
  return sendBytes(link::seal(command));
}

LinkClient::SendStatus LinkClient::send(link::Request& request) noexcept {
  if (operationNamed(request.operation.view()) == Operation::kEstop)
    (void)estopWay().send(request.client.view());
  if (request.received_ns == 0) request.received_ns = nowNs();
  return sendBytes(link::seal(request));
}

void LinkClient::prepareEstop() noexcept { (void)estopWay(); }

const link::EstopDatagram& LinkClient::estopWay() noexcept {
  return estop_ ? *estop_ : estop_.emplace(link::EstopDatagram::to(socket_path_));
}

LinkClient::SendStatus LinkClient::send(link::Signals& signals) noexcept {
  if (signals.received_ns == 0) signals.received_ns = nowNs();
  return sendBytes(link::seal(signals));
}

LinkClient::SendStatus LinkClient::send(link::TraceChoice& choice) noexcept {
  return sendBytes(link::seal(choice));
}

LinkClient::SendStatus LinkClient::sendBytes(std::span<const std::byte> bytes) noexcept {
  for (;;) {
    if (::send(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) {
      return SendStatus::kSent;
    }
    if (errno == EINTR) continue;
    return errno == EAGAIN || errno == ENOBUFS ? SendStatus::kBusy : SendStatus::kClosed;
  }
}

LinkClient::Received LinkClient::receive(std::span<std::byte> buffer) noexcept {
  for (;;) {
    const ssize_t size = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (size > 0) {
      const auto length = static_cast<std::size_t>(size);
      if (length > buffer.size()) continue;  // larger than any message there is: not for us
      return {ReceiveStatus::kMessage, buffer.first(length)};
    }
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) return {ReceiveStatus::kNothing, {}};
    return {ReceiveStatus::kClosed, {}};
  }
}

}  // namespace rc10
