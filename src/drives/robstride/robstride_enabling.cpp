#include "drives/robstride/robstride_enabling.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rc10 {
namespace {

constexpr Duration kRobstridePatience = std::chrono::milliseconds{50};
constexpr int kRobstrideAttempts = 5;
constexpr float kLimitTolerance = 1.01F;

}  // namespace

RobstrideSetting RobstrideSetting::limit(std::uint16_t index, float value) noexcept {
  return {.index = index, .bits = std::bit_cast<std::uint32_t>(value), .at_most = true};
}

bool RobstrideSetting::agrees(std::uint32_t read_bits) const noexcept {
  if (!at_most) return read_bits == bits;
  const auto kept = std::bit_cast<float>(read_bits);
  return kept >= 0.0F && kept <= std::bit_cast<float>(bits) * kLimitTolerance;
}

RobstrideEnabling::RobstrideEnabling() noexcept : sequence_(kRobstridePatience, kRobstrideAttempts) {}

void RobstrideEnabling::add(const RobstrideSetting& setting) noexcept {
  if (count_ < settings_.size()) settings_[count_++] = setting;
}

void RobstrideEnabling::begin() noexcept {
  sequence_.begin(0);
  culprit_.reset();
}

void RobstrideEnabling::advance() noexcept {
  if (atEnable()) return sequence_.finish();
  sequence_.next(step() + 1);
}

std::size_t RobstrideEnabling::pack(MonotonicTime now, const robstride::Codec& codec, bool operation,
                                    std::span<CanFrame> out) noexcept {
  if (out.size() < 3 || !sequence_.asks(now)) return 0;
  if (atSetting()) {
    const auto& setting = settings_[step() - 1];
    out[0] = codec.write(setting.index, setting.bits);
    out[1] = codec.read(setting.index);
    return 2;
  }
  if (atPosition()) {
    out[0] = codec.read(robstride::parameter::kPosition);
    return 1;
  }
  if (!atEnable()) {
    out[0] = codec.stop();
    return 1;
  }
  std::size_t count = 0;
  if (operation) out[count++] = codec.operate({});
  out[count++] = codec.enable();
  if (operation) out[count++] = codec.operate({});
  return count;
}

void RobstrideEnabling::onFeedback(const robstride::Feedback& seen) noexcept {
  if (!sequence_.awaits()) return;
  if (step() == 0 ? seen.mode == 0 : atEnable() && seen.mode == robstride::kRunning) advance();
}

bool RobstrideEnabling::contradicts(std::uint16_t index, std::uint32_t bits) const noexcept {
  if (sequence_.failed()) return false;
  const std::size_t confirmed =
      sequence_.done() ? count_ : std::min(count_, std::max(step(), std::size_t{1}) - 1);
  return std::any_of(settings_.begin(), settings_.begin() + static_cast<std::ptrdiff_t>(confirmed),
                     [&](const RobstrideSetting& each) {
                       return each.index == index && !each.rewritten && !each.agrees(bits);
                     });
}

void RobstrideEnabling::onParameter(std::uint16_t index, bool accepted, std::uint32_t bits) noexcept {
  if (accepted && contradicts(index, bits)) {
    culprit_ = index;
    return sequence_.fail();
  }
  if (!sequence_.awaits() || !accepted) return;
  if (atSetting()) {
    const auto& setting = settings_[step() - 1];
    if (index == setting.index && setting.agrees(bits)) advance();
  } else if (atPosition() && index == robstride::parameter::kPosition &&
             std::isfinite(std::bit_cast<float>(bits))) {
    advance();
  }
}

}  // namespace rc10
