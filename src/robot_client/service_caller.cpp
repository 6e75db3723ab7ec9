#include <cerrno>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>

#include "app/utime.hpp"
#include "rc10/service_client.hpp"
#include "rc10/service_request_t.hpp"
#include "rc10/service_response_t.hpp"
#include "robot_client/session/host_clock.hpp"
#include "robot_client/session/session_number.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using Kind = ServiceError::Kind;

[[nodiscard]] tl::unexpected<ServiceError> error(Kind kind, std::string message) {
  return tl::unexpected(ServiceError{kind, std::move(message)});
}

}  // namespace

struct ServiceCaller::Impl {
  Impl(const LcmLink& the_link, std::string the_name, std::string the_client)
      : link(the_link),
        name(std::move(the_name)),
        client(the_client.empty() ? program_invocation_short_name : std::move(the_client)) {}

  void receive(std::span<const std::byte> bytes) {
    service_response_t response;
    const bool ours = LcmLink::decode(bytes, response);
    {
      const std::lock_guard lock(mutex);
      foreign = foreign || !ours;
      // All clients of the service hear all answers.
      if (!ours || response.session != session || response.client != client) return;
      const auto found = open.find(response.seq);
      if (found == open.end() || found->second) return;
      found->second = std::move(response);
    }
    changed.notify_all();
  }

  LcmLink link;
  std::string name;
  std::string client;
  const std::int64_t session = newSessionNumber();
  std::mutex mutex;
  std::condition_variable changed;
  std::int64_t seq = 0;
  bool foreign = false;
  std::map<std::int64_t, std::optional<service_response_t>> open;
  Subscription responses;
};

ServiceCaller::ServiceCaller(const LcmLink& link, std::string name, std::string client)
    : impl_(std::make_unique<Impl>(link, std::move(name), std::move(client))) {
  impl_->responses =
      link.subscribe(impl_->name + ".response", [impl = impl_.get()](auto bytes) { impl->receive(bytes); });
}

ServiceCaller::~ServiceCaller() { impl_->responses.end(); }

tl::expected<std::vector<std::byte>, ServiceError> ServiceCaller::call(std::span<const std::byte> request,
                                                                       std::int64_t request_type,
                                                                       std::int64_t response_type,
                                                                       const CallOptions& options) {
  Impl& my = *impl_;
  if (my.link.inHandler()) return error(Kind::kNotSent, "a call in a callback would wait for itself");
  service_request_t message{};
  message.utime = utimeOf(std::chrono::system_clock::now());
  message.client = my.client;
  message.session = my.session;
  message.timeout_ms = static_cast<std::int32_t>(options.timeout.count());
  message.request_type = request_type;
  message.response_type = response_type;
  const auto* data = reinterpret_cast<const std::uint8_t*>(request.data());
  message.payload.assign(data, data + request.size());
  message.size = static_cast<std::int32_t>(message.payload.size());

  const auto deadline = timeNow() + options.timeout;
  std::optional<service_response_t> answer;
  bool foreign = false;
  {
    std::unique_lock lock(my.mutex);
    message.seq = ++my.seq;
    my.open[message.seq] = std::nullopt;
    for (auto now = timeNow(); now < deadline && !answer; now = timeNow()) {
      if (const auto sent = my.link.publish(my.name + ".request", message); !sent) {
        my.open.erase(message.seq);
        return error(Kind::kNotSent, sent.error().message);
      }
      const auto again =
          std::min<MonotonicTime>(deadline, now + std::max(options.repeat, std::chrono::milliseconds{1}));
      my.changed.wait_until(lock, again, [&] { return my.open[message.seq].has_value(); });
      answer = my.open[message.seq];
    }
    my.open.erase(message.seq);
    foreign = my.foreign;
  }
  if (!answer && foreign) {
    return error(Kind::kNoAnswer, "messages with other definitions arrive on " + my.name +
                                      ".response: build both programs with the same rc10");
  }
  if (!answer) {
    return error(Kind::kNoAnswer,
                 "no answer from service '" + my.name + "' within " +
                     std::to_string(options.timeout.count()) +
                     " ms: is the program that serves it running, and does it use the same LCM "
                     "address? Or does its handler take longer?");
  }
  if (answer->status == service_response_t::STATUS_REFUSED) {
    return error(Kind::kRefused, "service '" + my.name + "' refused: " + answer->message);
  }
  if (answer->status != service_response_t::STATUS_OK) {
    return error(Kind::kFailed, "service '" + my.name + "' failed: " + answer->message);
  }
  const auto bytes = std::as_bytes(std::span{answer->payload});
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace robot_client
}  // namespace rc10
