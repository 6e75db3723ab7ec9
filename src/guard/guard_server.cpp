#include "guard/guard_server.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

#include "app/timespec.hpp"
#include "link/descriptor_message.hpp"
#include "link/guard_hello.hpp"

namespace rc10::guard {
namespace {

// Connections without a hello, at the same time.
constexpr std::size_t kMaxVisitors = 8;
// Longest wait of a guard without a robot, until it checks whether it is still needed.
constexpr Duration kLongestWait = std::chrono::seconds{10};
constexpr std::string_view kNoDescriptors =
    "no file descriptors left: an rc10d was sent away, which nobody watches now; raise the limit "
    "(LimitNOFILE= of the unit, `ulimit -n`)";
constexpr Duration kStep = std::chrono::milliseconds{Standstill::kStepMs};

bool happened(const pollfd& descriptor) noexcept { return descriptor.revents != 0; }

void answer(int connection, std::string_view text) noexcept {
  (void)!::send(connection, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace

GuardServer::GuardServer(GuardSocket socket) : socket_(std::move(socket)) {}

bool GuardServer::rests() const noexcept {
  return std::any_of(robots_.begin(), robots_.end(), [](const auto& robot) { return robot.rests(); });
}

std::vector<std::string> GuardServer::serve(const sigset_t& signals_while_waiting) {
  const auto start = std::chrono::steady_clock::now();
  // By the wait's own end and not by a timerfd, whose expiry on PREEMPT_RT waits for ktimers (FIFO 1).
  const Duration patience =
      robots_.empty() ? kLongestWait : std::clamp(next_step_ - start, Duration::zero(), kStep);
  std::vector<pollfd> wait_for{{.fd = socket_.descriptor(), .events = POLLIN, .revents = 0}};
  for (const auto& robot : robots_)
    wait_for.push_back({.fd = robot.deathDescriptor(), .events = POLLIN, .revents = 0});
  for (const auto& visitor : visitors_)
    wait_for.push_back({.fd = visitor.get(), .events = POLLIN, .revents = 0});
  std::vector<std::string> news;
  const timespec at_most = toTimespec(patience);
  const int ready = ::ppoll(wait_for.data(), wait_for.size(), &at_most, &signals_while_waiting);
  if (ready < 0) return news;
  const auto now = std::chrono::steady_clock::now();
  const bool due = now >= next_step_;
  if (due) next_step_ = now + kStep;
  const auto deaths = std::span<const pollfd>{wait_for}.subspan(1, robots_.size());
  // A death is acted upon at once; steps have their time.
  if (due || std::any_of(deaths.begin(), deaths.end(), happened)) step(deaths, news);
  if (ready == 0) return news;
  if (wait_for[0].revents != 0) welcome(news);
  hear(news);
  return news;
}

void GuardServer::step(std::span<const pollfd> deaths, std::vector<std::string>& news) {
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (auto line = robots_[i].step(happened(deaths[i])); !line.empty()) news.push_back(std::move(line));
  }
  for (auto& dead : robots_) {
    if (dead.deathDescriptor() >= 0) continue;
    for (const auto& living : robots_) {
      if (living.deathDescriptor() >= 0 && living.ticks()) dead.handOver(living);
    }
  }
  std::erase_if(robots_, [](const auto& robot) { return robot.over(); });
}

void GuardServer::welcome(std::vector<std::string>& news) {
  auto visitor = socket_.accept();
  if (visitor.sent_away) news.emplace_back(kNoDescriptors);
  if (visitor.connection && visitors_.size() < kMaxVisitors)
    visitors_.push_back(std::move(visitor.connection));
}

void GuardServer::hear(std::vector<std::string>& news) {
  for (auto& visitor : visitors_) {
    link::DescriptorMessage message;
    if (!link::receiveWithDescriptors(visitor.get(), message)) {
      if (errno != EAGAIN && errno != EINTR) visitor.reset();
      continue;
    }
    auto robot = WatchedRobot::from(std::move(message));
    if (robot) {
      answer(visitor.get(), link::kGuardArmed);
      robot->keep(std::move(visitor));
      robots_.push_back(std::move(*robot));
    } else {
      answer(visitor.get(), robot.error().message);
      news.push_back("a robot is not watched: " + robot.error().message);
      visitor.reset();
    }
  }
  std::erase_if(visitors_, [](const auto& visitor) { return !visitor; });
}

}  // namespace rc10::guard
