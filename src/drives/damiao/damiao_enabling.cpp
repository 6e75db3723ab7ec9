#include "drives/damiao/damiao_enabling.hpp"

#include <cmath>

namespace rc10 {

using damiao::Register;

namespace {

constexpr Duration kRegisterPatience = std::chrono::milliseconds{50};
constexpr int kRegisterTries = 5;
// A scale is a float on the drive and a decimal number in the configuration.
constexpr double kSameScale = 1e-4;

}  // namespace

void DamiaoEnabling::begin() noexcept {
  step_ = kDisable;
  sent_ = 0;
  send_ = true;
  culprit_.reset();
}

void DamiaoEnabling::skip() noexcept {
  step_ = kDone;
  send_ = false;
  culprit_.reset();
}

void DamiaoEnabling::next() noexcept {
  step_ = static_cast<Step>(step_ + 1);
  sent_ = 0;
  send_ = step_ < kDone;
}

void DamiaoEnabling::fail() noexcept {
  culprit_ = registerOf(step_);
  step_ = kFailed;
  send_ = false;
}

std::optional<Register> DamiaoEnabling::registerOf(Step step) const noexcept {
  switch (step) {
    case kReadPMax: return Register::kPMax;
    case kReadVMax: return Register::kVMax;
    case kReadTMax: return Register::kTMax;
    case kWriteControl:
    case kReadControl: return Register::kControlMode;
    case kWriteTimeout:
    case kReadTimeout: return Register::kTimeout;
    case kReadPosition: return Register::kOutputPosition;
    case kDisable:
    case kEnable:
    case kDone:
    case kFailed: break;
  }
  return std::nullopt;
}

void DamiaoEnabling::update(MonotonicTime now) noexcept {
  if (step_ >= kDone || send_ || now - sent_at_ < kRegisterPatience) return;
  if (sent_ < kRegisterTries) {
    send_ = true;
    return;
  }
  // Without its count the drive can be told torques and speeds, but no angles.
  const bool angles_only =
      plan_.control == DamiaoControl::kPositionVelocity || plan_.control == DamiaoControl::kForcePosition;
  if (step_ == kReadPosition && !angles_only) {
    next();
  } else {
    fail();
  }
}

void DamiaoEnabling::onStatus(std::uint8_t status) noexcept {
  if (step_ >= kDone) return;
  if (status >= damiao::kFirstFault) {
    step_ = kFailed;
    send_ = false;
    return;
  }
  const bool answers = (step_ == kDisable && status == damiao::kStatusDisabled) ||
                       (step_ == kEnable && status == damiao::kStatusEnabled);
  if (answers && sent_ > 0) next();
}

bool DamiaoEnabling::asPlanned(const damiao::RegisterReply& reply) const noexcept {
  const auto same = [&reply](double planned) {
    const double told = static_cast<double>(damiao::floatOf(reply.value));
    return std::fabs(told - planned) <= kSameScale * planned;
  };
  switch (reply.address) {
    case Register::kPMax: return same(plan_.scale.p_max_rad);
    case Register::kVMax: return same(plan_.scale.v_max_rad_s);
    case Register::kTMax: return same(plan_.scale.t_max_nm);
    case Register::kControlMode: return reply.value == static_cast<std::uint32_t>(plan_.control);
    case Register::kTimeout: return reply.value == plan_.timeout;
    default: break;
  }
  return false;
}

void DamiaoEnabling::onReply(const damiao::RegisterReply& reply) noexcept {
  if (step_ == kReadPosition || sent_ == 0 || registerOf(step_) != reply.address) return;
  const bool writes = step_ == kWriteControl || step_ == kWriteTimeout;
  if (reply.written != writes) return;
  if (asPlanned(reply)) {
    next();
  } else {
    fail();
  }
}

void DamiaoEnabling::onPosition(bool known) noexcept {
  if (step_ == kReadPosition && sent_ > 0 && known) next();
}

DamiaoEnabling::Request DamiaoEnabling::request() const noexcept {
  if (step_ == kDisable) return {false, damiao::special(damiao::Special::kDisable)};
  if (step_ == kEnable) return {false, damiao::special(damiao::Special::kEnable)};
  const auto address = registerOf(step_).value_or(Register::kTimeout);
  switch (step_) {
    case kWriteControl:
      return {true, damiao::writeRegister(plan_.id, address, static_cast<std::uint32_t>(plan_.control))};
    case kWriteTimeout: return {true, damiao::writeRegister(plan_.id, address, plan_.timeout)};
    default: return {true, damiao::readRegister(plan_.id, address)};
  }
}

std::optional<DamiaoEnabling::Request> DamiaoEnabling::take(MonotonicTime now) noexcept {
  if (!send_) return std::nullopt;
  send_ = false;
  ++sent_;
  sent_at_ = now;
  return request();
}

SequenceProgress DamiaoEnabling::progress() const noexcept {
  if (step_ == kDone) return SequenceProgress::kDone;
  return step_ == kFailed ? SequenceProgress::kFailed : SequenceProgress::kPending;
}

}  // namespace rc10
