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

DamiaoEnabling::DamiaoEnabling(const Plan& plan) noexcept
    : plan_(plan), sequence_(kRegisterPatience, kRegisterTries) {}

void DamiaoEnabling::begin() noexcept {
  sequence_.begin(kDisable);
  culprit_.reset();
}

void DamiaoEnabling::next() noexcept {
  if (sequence_.step() == kEnable) return sequence_.finish();
  sequence_.next(static_cast<Step>(sequence_.step() + 1));
}

void DamiaoEnabling::fail() noexcept {
  culprit_ = registerOf(sequence_.step());
  sequence_.fail();
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
    case kEnable: break;
  }
  return std::nullopt;
}

void DamiaoEnabling::update(MonotonicTime now) noexcept {
  if (!sequence_.exhausted(now)) return;
  // Without its count the drive can be told torques and speeds, but no angles.
  const bool angles_only =
      plan_.control == DamiaoControl::kPositionVelocity || plan_.control == DamiaoControl::kForcePosition;
  if (sequence_.step() == kReadPosition && !angles_only) {
    next();
  } else {
    fail();
  }
}

void DamiaoEnabling::onStatus(std::uint8_t status) noexcept {
  if (!sequence_.pending()) return;
  if (status >= damiao::kFirstFault) return sequence_.fail();
  const bool answers = (sequence_.awaits(kDisable) && status == damiao::kStatusDisabled) ||
                       (sequence_.awaits(kEnable) && status == damiao::kStatusEnabled);
  if (answers) next();
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

bool DamiaoEnabling::confirmed(Register address) const noexcept {
  if (sequence_.failed()) return false;
  const auto past = [this](Step last) { return sequence_.done() || sequence_.step() > last; };
  switch (address) {
    case Register::kPMax: return past(kReadPMax);
    case Register::kVMax: return past(kReadVMax);
    case Register::kTMax: return past(kReadTMax);
    case Register::kControlMode: return past(kReadControl);
    case Register::kTimeout: return past(kReadTimeout);
    default: return false;
  }
}

void DamiaoEnabling::onReply(const damiao::RegisterReply& reply) noexcept {
  if (confirmed(reply.address)) {
    if (asPlanned(reply)) return;
    culprit_ = reply.address;
    return sequence_.fail();
  }
  const Step step = sequence_.step();
  if (step == kReadPosition || !sequence_.awaits() || registerOf(step) != reply.address) return;
  const bool writes = step == kWriteControl || step == kWriteTimeout;
  if (reply.written != writes) return;
  if (asPlanned(reply)) {
    next();
  } else {
    fail();
  }
}

void DamiaoEnabling::onPosition(bool known) noexcept {
  if (sequence_.awaits(kReadPosition) && known) next();
}

DamiaoEnabling::Request DamiaoEnabling::request() const noexcept {
  const Step step = sequence_.step();
  if (step == kDisable) return {false, damiao::special(damiao::Special::kDisable)};
  if (step == kEnable) return {false, damiao::special(damiao::Special::kEnable)};
  const auto address = registerOf(step).value_or(Register::kTimeout);
  switch (step) {
    case kWriteControl:
      return {true, damiao::writeRegister(plan_.id, address, static_cast<std::uint32_t>(plan_.control))};
    case kWriteTimeout: return {true, damiao::writeRegister(plan_.id, address, plan_.timeout)};
    default: return {true, damiao::readRegister(plan_.id, address)};
  }
}

std::optional<DamiaoEnabling::Request> DamiaoEnabling::take(MonotonicTime now) noexcept {
  if (!sequence_.asks(now)) return std::nullopt;
  return request();
}

}  // namespace rc10
