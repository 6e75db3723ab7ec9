#include "bus/bus_health.hpp"

#include <linux/can/error.h>

namespace rc10 {
namespace {

// CAN_ERR_CNT, "data[6] and data[7] hold TEC and REC": Linux 6.0; Ubuntu 22.04's headers lack it.
constexpr std::uint32_t kCountersValid = 0x200;

constexpr std::uint8_t kWarningBits = CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;
constexpr std::uint8_t kPassiveBits = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
constexpr std::uint8_t kActiveBit = 0x40;  // CAN_ERR_CRTL_ACTIVE

}  // namespace

void BusHealth::onErrorFrame(const CanFrame& frame) noexcept {
  ++error_frames_;
  const std::uint32_t classes = frame.id.value;
  const std::uint8_t crtl = (classes & CAN_ERR_CRTL) != 0 ? frame.data[1] : std::uint8_t{0};
  const bool restarted = (classes & CAN_ERR_RESTARTED) != 0;
  const bool was_off = controller_ == BusState::kBusOff;
  bool changed = true;
  if ((classes & CAN_ERR_BUSOFF) != 0) {
    controller_ = BusState::kBusOff;
  } else if ((crtl & kPassiveBits) != 0) {
    controller_ = BusState::kPassive;
  } else if ((crtl & kWarningBits) != 0) {
    controller_ = BusState::kWarning;
  } else if (restarted || (crtl & kActiveBit) != 0) {
    controller_ = BusState::kActive;
  } else {
    changed = false;
  }
  // Any state but bus-off proves a restart; and the message about bus-off may have been lost.
  if (controller_ != BusState::kBusOff && (was_off || restarted)) ++restarts_;

  // Kernels before 6.0 fill the counters of state changes without saying so; zero then means unknown.
  const bool told =
      (classes & kCountersValid) != 0 || (crtl != 0 && changed && (frame.data[6] != 0 || frame.data[7] != 0));
  if (told) {
    tec_ = frame.data[6];
    rec_ = frame.data[7];
  } else if (changed) {
    tec_ = -1;
    rec_ = -1;
  }
}

void BusHealth::onLink(CanLinkState link) noexcept {
  if (link == link_) return;
  if (link == CanLinkState::kUp) {
    // A controller that is brought up starts in error-active and sends no message about it.
    ++restarts_;
    controller_ = BusState::kActive;
    tec_ = -1;
    rec_ = -1;
  }
  link_ = link;
}

void BusHealth::onControllerRunning() noexcept {
  if (controller_ != BusState::kBusOff) return;
  ++restarts_;
  controller_ = BusState::kActive;
  tec_ = -1;
  rec_ = -1;
}

void BusHealth::update(MonotonicTime now, const Traffic& traffic) noexcept {
  const bool carrying = link_ == CanLinkState::kUp && controller_ != BusState::kBusOff;
  // A bus that comes back gets the whole time again before it is called silent or stalled.
  const bool heard = traffic.rx_frames != seen_.rx_frames;
  if (!started_ || !carrying || !traffic.feedback_expected || heard) last_rx_ = now;
  silent_ = now - last_rx_ >= config_.silent_after;

  const bool sent = traffic.tx_watched != seen_.tx_watched;
  // A queue that stays full is a bus that does not carry frames either; one that takes some again is not
  // full.
  const bool refused = traffic.tx_refused != seen_.tx_refused;
  const bool taken = traffic.tx_frames != seen_.tx_frames;
  if (only_refused_ && taken && !stalled_) echo_pending_ = false;
  const bool echoed = traffic.tx_confirmed != seen_.tx_confirmed;
  // Any echo counts, also of another frame: one lost frame must not stall the bus for ever.
  if (!carrying || traffic.echo_reads == 0 || echoed) {
    echo_pending_ = false;
    stalled_ = false;
  } else if ((sent || refused) && !echo_pending_) {
    echo_pending_ = true;
    only_refused_ = !sent;
    echo_pending_since_ = now;
    echo_pending_ticks_ = 0;
  } else if (echo_pending_ && echo_pending_ticks_ < config_.stalled_ticks) {
    if (traffic.echo_reads != seen_.echo_reads) ++echo_pending_ticks_;
  }
  // Once stalled we stop sending, so only an echo or the link's return ends it.
  if (echo_pending_ && now - echo_pending_since_ >= config_.stalled_after &&
      echo_pending_ticks_ >= config_.stalled_ticks) {
    stalled_ = true;
  }
  seen_ = traffic;
  started_ = true;
}

BusState BusHealth::state() const noexcept {
  if (link_ == CanLinkState::kGone) return BusState::kGone;
  if (link_ == CanLinkState::kDown) return BusState::kDown;
  if (controller_ == BusState::kBusOff) return BusState::kBusOff;
  if (stalled_) return BusState::kStalled;
  if (silent_) return BusState::kSilent;
  return controller_;
}

}  // namespace rc10
