#include "sim/sim_port.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "app/errno_text.hpp"
#include "bus/wire_frame.hpp"

namespace rc10::sim {
namespace {

// Enough to empty the queue of any bus in one step, and an end in case somebody writes faster than this
// reads.
constexpr int kMostReads = 16;

// Period of the drives that talk unasked.
constexpr Duration kPeriod = std::chrono::milliseconds{1};
// A step of up to this is one: all of its feedback periods come to one frame each.
constexpr Duration kLate = kPeriod * 3 / 2;
// Room for what a step makes up for, if the kernel allows it.
constexpr int kSendBufferBytes = 1 << 20;

}  // namespace

Result<std::pair<UniqueFd, UniqueFd>> SimPort::makeSocketPair() {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return fail("simulated bus: cannot make a socket pair: " + errnoText(errno));
  }
  std::pair<UniqueFd, UniqueFd> pair{UniqueFd{ends[0]}, UniqueFd{ends[1]}};
  for (const int fd : ends) {
    const int on = 1;
    // Emulated by qemu-user there is no such option: frames then count as received when they are read.
    if (::setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) != 0 && errno != ENOPROTOOPT) {
      return fail("simulated bus: cannot ask for receive stamps: " + errnoText(errno));
    }
    (void)::setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &kSendBufferBytes, sizeof(kSendBufferBytes));
  }
  return pair;
}

struct SimPort::Outbox {
  static constexpr std::size_t kCapacity = 64;

  Outbox() noexcept {
    for (std::size_t i = 0; i < kCapacity; ++i) {
      contents[i].iov_base = &messages[i];
      headers[i].msg_hdr.msg_iov = &contents[i];
      headers[i].msg_hdr.msg_iovlen = 1;
    }
  }

  std::array<StampedFrame, kCapacity> messages{};
  std::array<iovec, kCapacity> contents{};
  std::array<mmsghdr, kCapacity> headers{};
};

SimPort::SimPort(UniqueFd fd, const SimBusConfig& config, Stamps stamps)
    : fd_(std::move(fd)),
      stamps_(stamps),
      bus_(config),
      receiver_(fd_.get()),
      outbox_(std::make_unique<Outbox>()),
      commands_(CanReceiver::kBatch),
      feedback_(SimBus::kMaxFramesPerStep) {}

SimPort::~SimPort() = default;

void SimPort::step(MonotonicTime now) noexcept {
  readCommands(now);
  const Duration passed = last_step_ ? std::max(now - *last_step_, Duration::zero()) : Duration::zero();
  last_step_ = last_step_ ? std::max(now, *last_step_) : now;
  const bool own = stamps_ == Stamps::kOwn;
  Duration dt = std::min(passed, own ? kLongestMadeUpFor : kLongestStep);
  counters_.skipped += passed - dt;
  for (; own && dt > kLate; dt -= kPeriod) advance(now - dt + kPeriod, kPeriod);
  advance(now, dt);
}

void SimPort::sentAt(MonotonicTime sent) noexcept {
  if (stamps_ == Stamps::kOwn || !last_step_ || sent - *last_step_ <= kLongestSending) return;
  counters_.skipped += sent - *last_step_;
  last_step_ = sent;
}

void SimPort::advance(MonotonicTime now, Duration dt) noexcept {
  writeFeedback(std::span(feedback_).first(bus_.step(now, dt, feedback_)));
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

void SimPort::writeFeedback(std::span<const CanFrame> frames) noexcept {
  while (!frames.empty()) {
    const auto batch = frames.first(std::min(frames.size(), Outbox::kCapacity));
    for (std::size_t i = 0; i < batch.size(); ++i) {
      auto& message = outbox_->messages[i];
      outbox_->contents[i].iov_len =
          stamps_ == Stamps::kOwn ? encodeFrame(batch[i], message) : encodeFrame(batch[i], message.frame);
    }
    // MSG_NOSIGNAL: the other end of a simulated bus may be gone, and SIGPIPE would end the process.
    const int taken = ::sendmmsg(fd_.get(), outbox_->headers.data(), static_cast<unsigned>(batch.size()),
                                 MSG_DONTWAIT | MSG_NOSIGNAL);
    const auto sent = static_cast<std::size_t>(std::max(taken, 0));
    counters_.sent += sent;
    counters_.refused += batch.size() - sent;
    frames = frames.subspan(batch.size());
  }
}

}  // namespace rc10::sim
