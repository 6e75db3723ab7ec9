#include "daemon/supervision/bus_scan.hpp"

#include <algorithm>

namespace rc10 {

void BusScan::enter(Phase phase, MonotonicTime until) noexcept {
  phase_ = phase;
  until_ = until;
}

void BusScan::begin(const Order& order, std::uint64_t error_frames, const Tick& tick) noexcept {
  order_ = order.scan;
  id_ = order.id;
  asked_ = 0;
  error_frames_ = error_frames;
  enter(Phase::kListening, tick.now + order_.listen);
}

void BusScan::hear(std::size_t bus, const CanFrame& frame) noexcept {
  if (phase_ == Phase::kIdle || bus != order_.bus || frame.type != FrameType::kData) return;
  if (!exchange_.heard.push(frame))
    exchange_.dropped.store(exchange_.dropped.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

BusScan::Progress BusScan::advance(const Tick& tick) noexcept {
  if (exchange_.given_up.load(std::memory_order_relaxed) == id_) return Progress::kGivenUp;
  if (phase_ == Phase::kListening && tick.now >= until_) {
    if (order_.listen_only) return Progress::kDone;
    exchange_.listened.store(id_, std::memory_order_release);
    enter(Phase::kJudging, tick.now + kJudging);
  }
  if (phase_ == Phase::kJudging) {
    if (exchange_.ready.load(std::memory_order_acquire) == id_) {
      next_question_ = tick.now;
      phase_ = Phase::kAsking;
    } else if (tick.now >= until_) {
      return Progress::kNotJudged;
    }
  }
  if (phase_ == Phase::kAsking && asked_ >= std::min(exchange_.question_count, exchange_.questions.size()))
    enter(Phase::kAnswering, tick.now + kAnswering);
  return phase_ == Phase::kAnswering && tick.now >= until_ ? Progress::kDone : Progress::kPending;
}

const CanFrame* BusScan::due(const Tick& tick) const noexcept {
  return phase_ == Phase::kAsking && tick.now >= next_question_ ? &exchange_.questions[asked_] : nullptr;
}

void BusScan::tookQuestion(const Tick& tick) noexcept {
  ++asked_;
  next_question_ = tick.now + order_.between;
}

}  // namespace rc10
