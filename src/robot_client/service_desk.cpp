#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>

#include "app/time.hpp"
#include "app/utime.hpp"
#include "rc10/service_request_t.hpp"
#include "rc10/service_response_t.hpp"
#include "rc10/service_server.hpp"
#include "robot_client/session/host_clock.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

constexpr std::size_t kMaxWaiting = 16;
constexpr std::size_t kMaxRemembered = 64;

[[nodiscard]] bool sameCall(const service_request_t& request, const service_response_t& response) {
  return request.seq == response.seq && request.session == response.session &&
         request.client == response.client;
}

[[nodiscard]] service_response_t answerTo(const service_request_t& request) {
  service_response_t response{};
  response.utime = utimeOf(std::chrono::system_clock::now());
  response.client = request.client;
  response.session = request.session;
  response.seq = request.seq;
  return response;
}

[[nodiscard]] service_response_t refusal(const service_request_t& request, std::string why) {
  auto response = answerTo(request);
  response.status = service_response_t::STATUS_REFUSED;
  response.message = std::move(why);
  return response;
}

}  // namespace

struct ServiceDesk::Impl {
  struct Call {
    service_request_t request;
    MonotonicTime received;
  };

  Impl(const LcmLink& the_link, std::string the_name, Types the_types, Handler the_handler)
      : link(the_link), name(std::move(the_name)), types(the_types), handler(std::move(the_handler)) {}

  void receive(std::span<const std::byte> bytes) {
    Call call{{}, timeNow() - link.waited()};
    if (!LcmLink::decode(bytes, call.request)) return;
    std::optional<service_response_t> answer;
    {
      const std::lock_guard lock(mutex);
      answer = decide(call);
    }
    changed.notify_all();
    if (answer) (void)link.publish(name + ".response", *answer);
  }

  // The answer to a call that is not to be carried out; the others wait in the queue.
  std::optional<service_response_t> decide(Call& call) {
    const auto& request = call.request;
    for (const auto& known : answered) {
      if (sameCall(request, known)) return known;
    }
    // Repeated while it waits or is carried out: answered when the first is.
    if (at_work && sameCall(request, *at_work)) return std::nullopt;
    for (const auto& other : waiting) {
      if (sameCall(other.request, answerTo(request))) return std::nullopt;
    }
    if (request.request_type != types.request || request.response_type != types.response) {
      return refusal(request,
                     "client and server were built with other definitions of the types of '" + name + "'");
    }
    if (waiting.size() >= kMaxWaiting) return refusal(request, "busy: 16 calls wait already");
    waiting.push_back(std::move(call));
    return std::nullopt;
  }

  void work() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return stop || !waiting.empty(); });
      if (stop) return;
      const Call call = std::move(waiting.front());
      waiting.pop_front();
      at_work = answerTo(call.request);
      lock.unlock();
      const auto response = carryOut(call);
      lock.lock();
      // Remembered before it is sent: whoever has the answer may ask again at once.
      at_work.reset();
      answered.push_back(response);
      if (answered.size() > kMaxRemembered) answered.pop_front();
      lock.unlock();
      (void)link.publish(name + ".response", response);
      lock.lock();
    }
  }

  [[nodiscard]] service_response_t carryOut(const Call& call) const {
    if (timeNow() > call.received + std::chrono::milliseconds{call.request.timeout_ms}) {
      return refusal(call.request, "too late: the client does not wait for it any more");
    }
    auto response = answerTo(call.request);
    try {
      const auto result = handler(std::as_bytes(std::span{call.request.payload}));
      if (result) {
        const auto* data = reinterpret_cast<const std::uint8_t*>(result->data());
        response.payload.assign(data, data + result->size());
        response.size = static_cast<std::int32_t>(response.payload.size());
      } else {
        response.status = service_response_t::STATUS_FAILED;
        response.message = result.error().message;
      }
    } catch (const std::exception& error) {
      response.status = service_response_t::STATUS_FAILED;
      response.message = error.what();
    }
    return response;
  }

  LcmLink link;
  std::string name;
  Types types;
  Handler handler;
  Result<void> status;
  std::mutex mutex;
  std::condition_variable changed;
  bool stop = false;
  std::deque<Call> waiting;
  std::optional<service_response_t> at_work;
  std::deque<service_response_t> answered;
  std::thread worker;
  Subscription requests;
};

ServiceDesk::ServiceDesk(const LcmLink& link, std::string name, Types types, Handler handler)
    : impl_(std::make_unique<Impl>(link, std::move(name), types, std::move(handler))) {
  impl_->status = link.status();
  if (!impl_->status) return;
  impl_->worker = std::thread([impl = impl_.get()] { impl->work(); });
  pthread_setname_np(impl_->worker.native_handle(), "rc10-service");
  impl_->requests =
      link.subscribe(impl_->name + ".request", [impl = impl_.get()](auto bytes) { impl->receive(bytes); });
}

ServiceDesk::~ServiceDesk() {
  impl_->requests.end();
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop = true;
  }
  impl_->changed.notify_all();
  if (impl_->worker.joinable()) impl_->worker.join();
}

const Result<void>& ServiceDesk::status() const noexcept { return impl_->status; }

}  // namespace robot_client
}  // namespace rc10
