#include "sim/sim_port.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

namespace rc10::sim {
namespace {

// Enough to empty the queue of any bus in one step, and an end in case somebody writes faster than this
// reads.
constexpr int kMostReads = 16;

}  // namespace

Result<std::pair<UniqueFd, UniqueFd>> SimPort::makeSocketPair() {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return fail("simulated bus: cannot make a socket pair: " + std::generic_category().message(errno) +
                "; raise the limit of open files (LimitNOFILE=) if that is the cause");
  }
  std::pair<UniqueFd, UniqueFd> pair{UniqueFd{ends[0]}, UniqueFd{ends[1]}};
  for (const int fd : ends) {
    const int on = 1;
    // Emulated by qemu-user there is no such option: frames then count as received when they are read.
    if (::setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) != 0 && errno != ENOPROTOOPT) {
      return fail("simulated bus: cannot ask for receive stamps: " + std::generic_category().message(errno));
    }
  }
  return pair;
}

SimPort::SimPort(UniqueFd fd, const SimBusConfig& config)
    : fd_(std::move(fd)),
      bus_(config),
      receiver_(fd_.get()),
      commands_(CanReceiver::kBatch),
      feedback_(SimBus::kMaxFramesPerStep) {}

void SimPort::step(MonotonicTime now) noexcept {
  readCommands(now);
  const Duration passed = last_step_ ? std::max(now - *last_step_, Duration::zero()) : Duration::zero();
  last_step_ = last_step_ ? std::max(now, *last_step_) : now;
  const Duration dt = std::min(passed, kLongestStep);
  counters_.skipped += passed - dt;
  writeFeedback(bus_.step(now, dt, feedback_));
}

void SimPort::sentAt(MonotonicTime sent) noexcept {
  if (!last_step_ || sent - *last_step_ <= kLongestSending) return;
  counters_.skipped += sent - *last_step_;
  last_step_ = sent;
}

void SimPort::readCommands(MonotonicTime now) noexcept {
  const WakeUp wake{.now = now, .previous = now, .realtime_offset = {}, .previous_offset = {}};
  for (int reads = 0; reads < kMostReads; ++reads) {
    const Reception reception = receiver_.receive(wake, commands_);
    for (const CanFrame& command : std::span(commands_).first(reception.frame_count)) bus_.receive(command);
    counters_.commands += reception.frame_count;
    counters_.malformed += reception.malformed_count;
    counters_.error = reception.error;
    const std::size_t read = reception.frame_count + reception.malformed_count;
    if (reception.error != 0 || read < CanReceiver::kBatch) return;
  }
}

void SimPort::writeFeedback(std::size_t count) noexcept {
  for (std::size_t next = 0; next < count;) {
    batch_.clear();
    while (next < count && batch_.room() > 0) batch_.add(feedback_[next++], std::nullopt);
    (void)batch_.send(fd_.get());
    for (const auto& entry : batch_.entries()) ++(entry.sent ? counters_.sent : counters_.refused);
  }
}

}  // namespace rc10::sim
