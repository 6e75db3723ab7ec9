#include "bus/fdcan_bus.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <utility>

#include "bus/frame_bits.hpp"
#include "bus/send_batch.hpp"

namespace rc10 {

static_assert(SendBatch::kCapacity == fdCANbus::kMaxFramesPerTick);

namespace {

bool sayTheSame(const CanFrame& a, const CanFrame& b) noexcept {
  const auto bytes = a.payload();
  return a.id == b.id && std::equal(bytes.begin(), bytes.end(), b.payload().begin(), b.payload().end());
}

/// A repetition of a frame of the last tick: a wire or a bridge that doubles frames is no other controller,
/// and commands nothing new.
bool isDoubled(const CanFrame& frame, const SendBatch& batch) noexcept {
  const auto sent = batch.cleared();
  return std::any_of(sent.begin(), sent.end(),
                     [&frame](const SendBatch::Entry& entry) { return sayTheSame(entry.frame, frame); });
}

}  // namespace

fdCANbus::fdCANbus(std::string name, CanSocket socket)
    : name_(std::move(name)), socket_(std::move(socket)), batch_(std::make_unique<SendBatch>()) {
  packers_.reserve(kMaxDevices);
}

fdCANbus::~fdCANbus() = default;

Result<std::unique_ptr<fdCANbus>> fdCANbus::open(std::string name, const std::string& interface,
                                                 const CanSocketOptions& options) {
  auto socket = openCanSocket(interface, options);
  if (!socket) return fail("bus '" + name + "': " + socket.error().message);
  return std::unique_ptr<fdCANbus>(new fdCANbus(std::move(name), std::move(*socket)));
}

std::unique_ptr<fdCANbus> fdCANbus::adopt(std::string name, UniqueFd fd, bool fd_frames) {
  return std::unique_ptr<fdCANbus>(new fdCANbus(std::move(name), CanSocket{std::move(fd), fd_frames, 0}));
}

Result<void> fdCANbus::registerMotor(FrameListener& device) {
  if (auto ok = table_.add(device); !ok) return fail("bus '" + name_ + "': " + ok.error().message);
  return {};
}

Result<void> fdCANbus::registerMotor(CommandPacker& packer) {
  const auto refuse = [&](const std::string& why) {
    return fail("bus '" + name_ + "': '" + std::string(packer.packerName()) + "' " + why);
  };
  if (packers_.size() >= kMaxDevices) {
    return refuse("is one too many: a bus holds at most " + std::to_string(kMaxDevices) + " senders");
  }
  for (const CommandPacker* other : packers_) {
    if (other == &packer) return refuse("is registered twice");
    const auto taken = other->commandIds();
    for (const CanId id : packer.commandIds()) {
      if (std::find(taken.begin(), taken.end(), id) == taken.end()) continue;
      return refuse("and '" + std::string(other->packerName()) + "' would both send " + describe(id) +
                    ": give one of them another id, or move it to another bus");
    }
  }
  packers_.push_back(&packer);
  return {};
}

void fdCANbus::dispatch(const CanFrame& frame) noexcept {
  if (tap_ != nullptr) tap_->onReceived(frame);
  if (frame.type == FrameType::kError) {
    health_.onErrorFrame(frame);
    return;
  }
  ++counters_.rx_frames;
  const FrameBits bits = unstuffedBits(shapeOf(frame));
  counters_.rx_bits += bits.nominal;
  if (bits.data != 0) counters_.rx_data_bits += bits.data;  // rare: spares a store
  FrameListener* const device = table_.find(frame);
  const auto verdict = device != nullptr ? device->updateFeedback(frame) : FrameVerdict::kForeign;
  if (verdict != FrameVerdict::kAccepted) putAside(frame, verdict, device == nullptr);
}

// Few frames come here: by itself, so that dispatch() stays short for the others.
void fdCANbus::putAside(const CanFrame& frame, FrameVerdict verdict, bool unmatched) noexcept {
  if (unmatched) ++counters_.rx_unmatched;
  if (verdict == FrameVerdict::kMalformed) ++counters_.rx_malformed;
  // The socket does not receive what it sends itself.
  if (verdict != FrameVerdict::kForeign || frame.type != FrameType::kData) return;
  if (isCommandId(frame.id) && !stops(frame)) {
    ++counters_.rx_foreign;
    last_foreign_ = {frame.id, frame.sent_here};
  }
  if (foreign_ != nullptr && !isDoubled(frame, *batch_)) foreign_->onForeign(*this, frame);
}

// They send each rest frame three times, and what a bus has kept of them comes once it carries frames again.
// A program that commands 0 goes on and on.
bool fdCANbus::stops(const CanFrame& frame) noexcept {
  constexpr int kMostASecond = 64;
  if (!frame.sent_here || !isRest(frame)) return false;
  if (frame.received - stops_since_ >= std::chrono::seconds{1}) {
    stops_since_ = frame.received;
    stops_ = 0;
  }
  return ++stops_ <= kMostASecond;
}

bool fdCANbus::isRest(const CanFrame& frame) const noexcept {
  std::array<CanFrame, kMaxFramesPerPacker> frames{};
  return std::any_of(packers_.begin(), packers_.end(), [&](const CommandPacker* packer) {
    const auto rest = std::span{frames}.first(packer->packRest(frames));
    return std::any_of(rest.begin(), rest.end(),
                       [&frame](const CanFrame& one) { return sayTheSame(one, frame); });
  });
}

// Asked for frames that no device claims: there are few of them, and few packers.
bool fdCANbus::isCommandId(CanId id) const noexcept {
  return std::any_of(packers_.begin(), packers_.end(), [id](const CommandPacker* packer) {
    const auto ids = packer->commandIds();
    return std::find(ids.begin(), ids.end(), id) != ids.end();
  });
}

bool fdCANbus::sendFrame(const CanFrame& frame) noexcept { return append(frame, std::nullopt); }

bool fdCANbus::hasRoom() const noexcept { return batch_->room() > 0; }

bool fdCANbus::append(const CanFrame& frame, std::optional<std::size_t> packer) noexcept {
  const bool possible = frame.type != FrameType::kError && (!frame.fd || fdFrames());
  if (possible && batch_->add(frame, packer)) return true;
  ++counters_.tx_dropped;
  return false;
}

void fdCANbus::packCommands(const Tick& tick) noexcept {
  packAll([&tick](CommandPacker& packer, std::span<CanFrame> out) { return packer.packCommand(tick, out); });
}

// The end waits for the echoes of rest, which a drive that is told in every n-th tick would give too late.
void fdCANbus::packLastCommands(const Tick& tick) noexcept {
  packAll([&tick](CommandPacker& packer, std::span<CanFrame> out) {
    const std::size_t count = packer.packCommand(tick, out);
    return count > 0 ? count : packer.packRest(out);
  });
}

void fdCANbus::packRest() noexcept {
  packAll([](const CommandPacker& packer, std::span<CanFrame> out) { return packer.packRest(out); });
}

template <typename Pack>
void fdCANbus::packAll(Pack pack) noexcept {
  for (std::size_t i = 0; i < packers_.size(); ++i) {
    const std::size_t packer = (first_packer_ + i) % packers_.size();
    const std::size_t count = std::min(pack(*packers_[packer], std::span<CanFrame>(packed_)), packed_.size());
    if (count > batch_->room()) {  // half a sequence is worse than none
      counters_.tx_dropped += count;
      if (!first_crowded_out_) first_crowded_out_ = packer;
      packers_[packer]->onUnsent();
      continue;
    }
    for (const CanFrame& frame : std::span(packed_).first(count)) append(frame, packer);
  }
}

void fdCANbus::flush() noexcept {
  const std::size_t stopped_at = batch_->send(descriptor());
  countSent();
  std::optional<std::size_t> first_refused = first_crowded_out_;
  for (const SendBatch::Entry& entry : batch_->entries().subspan(stopped_at)) {
    if (!entry.packer) continue;
    first_refused = entry.packer;
    break;
  }
  first_packer_ = first_refused.value_or(first_packer_);
  first_crowded_out_.reset();
  batch_->clear();
}

void fdCANbus::holdBack() noexcept {
  counters_.tx_held += batch_->entries().size();
  for (const SendBatch::Entry& entry : batch_->entries()) tellUnsent(entry.packer);
  first_crowded_out_.reset();
  batch_->clear();
}

int fdCANbus::sendError() const noexcept { return batch_->error(); }

void fdCANbus::tellUnsent(std::optional<std::size_t> packer) const noexcept {
  if (packer) packers_[*packer]->onUnsent();
}

void fdCANbus::countSent() noexcept {
  for (const SendBatch::Entry& entry : batch_->entries()) {
    if (tap_ != nullptr) tap_->onSent(entry.frame, entry.sent);
    if (std::find(watched_.begin(), watched_.end(), entry.frame.id) != watched_.end())
      ++(entry.sent ? counters_.tx_watched : counters_.tx_watched_refused);
    if (!entry.sent) {
      ++counters_.tx_dropped;
      tellUnsent(entry.packer);
      continue;
    }
    ++counters_.tx_frames;
    counters_.tx_bits += entry.bits.nominal;
    counters_.tx_data_bits += entry.bits.data;
  }
}

}  // namespace rc10
