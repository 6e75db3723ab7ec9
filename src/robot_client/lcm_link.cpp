#include "rc10/lcm_link.hpp"

#include <lcm/lcm.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <mutex>
#include <string_view>
#include <thread>

#include <pthread.h>

#include "app/unique_fd.hpp"
#include "robot_client/own_datagrams.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

constexpr int kQueueCapacity = 100;
constexpr std::size_t kMaxChannelLength = 63;

using RawHandler = std::function<void(const std::string& channel, std::span<const std::byte> message)>;

// LCM takes a regular expression.
[[nodiscard]] std::string literal(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') pattern += '\\';
    pattern += c;
  }
  return pattern;
}

[[nodiscard]] std::string effectiveUrl(const std::string& url) {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  return !url.empty() ? url : environment != nullptr ? environment : "";
}

[[nodiscard]] std::string startFailure(const std::string& url) {
  const std::string effective = effectiveUrl(url);
  if (!effective.empty() && effective.rfind("udpm://", 0) != 0) {
    return "LCM could not start with '" + effective + "'";
  }
  return "LCM could not start" + (effective.empty() ? "" : " with '" + effective + "'") +
         ". Usually there is no route for its multicast. Run: sudo ip route add 239.255.76.67/32 dev lo src "
         "127.0.0.1 "
         "(and only if that is not enough: sudo ip link set lo multicast on)";
}

// Time at which this computer received the message that this thread handles, by the clock of liblcm.
thread_local std::int64_t t_received_us = 0;

void notify(int event) noexcept { (void)::eventfd_write(event, 1); }

}  // namespace

/// One subscription. The mutex is recursive: a handler may end its own.
struct Subscription::Handler {
  lcm_subscription_t* subscribed = nullptr;
  std::weak_ptr<void> owner;
  int ended = -1;  ///< The owner's: to be written to when `alive` is no more.
  std::recursive_mutex mutex;
  std::atomic<bool> alive{true};
  RawHandler call;
};

Subscription& Subscription::operator=(Subscription&& other) noexcept {
  if (this != &other) {
    end();
    handler_ = std::move(other.handler_);
  }
  return *this;
}

void Subscription::end() noexcept {
  if (!handler_) return;
  // A connection that has ended has freed its subscriptions.
  if (const auto owner = handler_->owner.lock()) {
    {
      const std::lock_guard lock(handler_->mutex);
      handler_->alive = false;
    }
    notify(handler_->ended);
  }
  handler_.reset();
}

struct LcmLink::Impl {
  OwnDatagrams datagrams;  // before liblcm opens anything
  lcm_t* lcm = nullptr;
  Result<void> status;
  UniqueFd stop;
  UniqueFd ended;
  std::mutex mutex;
  std::vector<std::shared_ptr<Subscription::Handler>> handlers;
  struct Witness {
    std::string robot;
    UniqueFd heard;
  };
  std::vector<Witness> witnesses;
  std::thread thread;

  explicit Impl(const std::string& url) : lcm(lcm_create(url.empty() ? nullptr : url.c_str())) {
    stop = UniqueFd{eventfd(0, EFD_CLOEXEC)};
    ended = UniqueFd{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
    if (lcm == nullptr) {
      status = fail(startFailure(url));
      return;
    }
    // Opens what receives; without a route it is this that fails.
    if (!stop || !ended || lcm_get_fileno(lcm) < 0) {
      status = fail(startFailure(url));
      return;
    }
    datagrams.keepOut(effectiveUrl(url));
    thread = std::thread([this] { receive(); });
    pthread_setname_np(thread.native_handle(), "rc10-link");
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (thread.joinable()) {
      notify(stop.get());
      thread.join();
    }
    if (lcm != nullptr) lcm_destroy(lcm);
  }

  void receive() {
    std::vector<pollfd> fds;
    while (true) {
      fds.assign({pollfd{lcm_get_fileno(lcm), POLLIN, 0}, pollfd{stop.get(), POLLIN, 0},
                  pollfd{ended.get(), POLLIN, 0}});
      {
        const std::lock_guard lock(mutex);
        for (const auto& witness : witnesses) fds.push_back({witness.heard.get(), POLLIN, 0});
      }
      if (::poll(fds.data(), fds.size(), -1) < 0) continue;  // a signal
      if (fds[1].revents != 0) return;
      // First, so that nothing of others comes after it.
      for (std::size_t i = 3; i < fds.size(); ++i)
        if (fds[i].revents != 0) isHere(fds[i].fd);
      if (fds[0].revents != 0) lcm_handle(lcm);
      if (fds[2].revents != 0) forgetEnded();
    }
  }

  // A robot whose state is subscribed to.
  void watch(const std::string& robot) {
    const std::lock_guard lock(mutex);
    for (const auto& witness : witnesses)
      if (witness.robot == robot) return;
    if (auto heard = datagrams.witnessOf(robot)) witnesses.push_back({robot, std::move(heard)});
  }

  void isHere(int heard) {
    const std::lock_guard lock(mutex);
    const auto witness = std::find_if(witnesses.begin(), witnesses.end(),
                                      [&](const auto& one) { return one.heard.get() == heard; });
    datagrams.isHere(witness->robot);
    witnesses.erase(witness);
  }

  // By this thread alone, between two messages: liblcm 1.3 loses a handler that another thread unsubscribes
  // while its channel is dispatched, and may call another one twice.
  void forgetEnded() {
    eventfd_t count = 0;
    (void)::eventfd_read(ended.get(), &count);
    std::vector<std::shared_ptr<Subscription::Handler>> gone;
    {
      const std::lock_guard lock(mutex);
      const auto first_gone = std::stable_partition(
          handlers.begin(), handlers.end(), [](const auto& handler) { return handler->alive.load(); });
      gone.assign(std::make_move_iterator(first_gone), std::make_move_iterator(handlers.end()));
      handlers.erase(first_gone, handlers.end());
    }
    for (const auto& handler : gone) lcm_unsubscribe(lcm, handler->subscribed);
  }

  static void received(const lcm_recv_buf_t* message, const char* channel, void* self) {
    auto& handler = *static_cast<Subscription::Handler*>(self);
    const std::lock_guard lock(handler.mutex);
    if (!handler.alive) return;
    t_received_us = message->recv_utime;
    handler.call(channel, {static_cast<const std::byte*>(message->data), message->data_size});
  }

  static std::shared_ptr<Subscription::Handler> subscribe(const std::shared_ptr<Impl>& self,
                                                          const std::string& pattern, RawHandler call) {
    if (self->lcm == nullptr) return nullptr;
    auto handler = std::make_shared<Subscription::Handler>();
    handler->owner = self;
    handler->ended = self->ended.get();
    handler->call = std::move(call);
    {
      const std::lock_guard lock(self->mutex);
      self->handlers.push_back(handler);
    }
    handler->subscribed = lcm_subscribe(self->lcm, pattern.c_str(), &Impl::received, handler.get());
    if (handler->subscribed == nullptr) return nullptr;
    lcm_subscription_set_queue_capacity(handler->subscribed, kQueueCapacity);
    return handler;
  }
};

LcmLink::LcmLink(const std::string& url) : impl_(std::make_shared<Impl>(url)) {}

Result<void> LcmLink::status() const { return impl_->status; }

Result<void> LcmLink::publish(const std::string& channel, std::span<const std::byte> message) const {
  if (!impl_->status) return impl_->status;
  if (channel.empty() || channel.size() > kMaxChannelLength) {
    return fail("'" + channel + "' is no channel: LCM allows 1 to 63 characters");
  }
  if (lcm_publish(impl_->lcm, channel.c_str(), message.data(), static_cast<unsigned>(message.size())) != 0) {
    return fail("LCM could not send on " + channel +
                ": see whether its multicast route is still there (ip route get 239.255.76.67)");
  }
  return {};
}

Subscription LcmLink::subscribe(const std::string& channel, Handler handler) const {
  constexpr std::string_view kState = ".v1.state";
  if (impl_->status && channel.ends_with(kState)) {
    impl_->watch(channel.substr(0, channel.size() - kState.size()));
    notify(impl_->ended.get());  // for the thread to wait for it, too
  }
  return Subscription{
      Impl::subscribe(impl_, literal(channel),
                      [handler = std::move(handler)](const std::string&, std::span<const std::byte> message) {
                        handler(message);
                      })};
}

Subscription LcmLink::subscribeBetween(const std::string& before, const std::string& after,
                                       std::function<void(const std::string& channel)> handler) const {
  return Subscription{
      Impl::subscribe(impl_, literal(before) + "[^.]+" + literal(after),
                      [handler = std::move(handler)](const std::string& channel, std::span<const std::byte>) {
                        handler(channel);
                      })};
}

bool LcmLink::moreWaits() const noexcept {
  if (impl_->lcm == nullptr) return false;
  pollfd entry{lcm_get_fileno(impl_->lcm), POLLIN, 0};
  return ::poll(&entry, 1, 0) > 0;
}

Duration LcmLink::waited() const noexcept {
  const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::system_clock::now().time_since_epoch());
  return std::max(Duration{}, Duration{now_us - std::chrono::microseconds{t_received_us}});
}

bool LcmLink::inHandler() const noexcept { return std::this_thread::get_id() == impl_->thread.get_id(); }

}  // namespace robot_client
}  // namespace rc10
