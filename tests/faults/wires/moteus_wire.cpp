// mjbots/moteus docs/protocol/{can,registers}.md: subframes that write, read or answer registers.
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "bus/can_frame.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

constexpr std::uint32_t kMode = 0x000;
constexpr std::uint32_t kPlace = 0x020;
constexpr std::uint32_t kVelocity = 0x021;
constexpr std::uint32_t kTorque = 0x022;
constexpr std::uint32_t kStiffness = 0x023;
constexpr std::uint32_t kDamping = 0x024;
constexpr std::uint32_t kMostTorque = 0x025;
constexpr std::uint32_t kTimeout = 0x027;
constexpr std::uint32_t kMostVelocity = 0x028;
constexpr std::uint32_t kIntegralLimit = 0x02B;
constexpr double kRoundRev = 65536.0;
// The point that moves with a velocity stays so near (docs/motors/moteus.md), and goes on for some
// turns of its commands.
constexpr double kSlipRev = 0.5;
constexpr double kSlipTurns = 2.0;
constexpr double kSlipSeconds = 0.004;
constexpr double kStopped = 0.0;
constexpr double kPosition = 10.0;
constexpr double kBrake = 15.0;

/// Scale of an 8, 16 and 32 bit integer.
[[nodiscard]] std::array<double, 3> scalesOf(std::uint32_t reg) {
  switch (reg) {
    case 0x001:
    case kPlace: return {0.01, 1e-4, 1e-5};
    case 0x002:
    case kVelocity:
    case kMostVelocity: return {0.1, 2.5e-4, 1e-5};
    case kMostVelocity + 1: return {0.05, 1e-3, 1e-5};
    case 0x003:
    case kTorque:
    case kMostTorque: return {0.5, 0.01, 0.001};
    case 0x004: return {1.0, 0.1, 0.001};
    case 0x00D: return {0.5, 0.1, 0.001};
    case 0x00E: return {1.0, 0.1, 0.001};
    case kTimeout: return {0.01, 0.001, 1e-6};
    case kStiffness:
    case kDamping:
    case kIntegralLimit: return {1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0};
    default: return {1.0, 1.0, 1.0};
  }
}

class MoteusWire final : public Wire {
 public:
  explicit MoteusWire(const MotorConfig& config) : Wire(config), own_(moteusSettings(config.settings.own)) {
    slip_s_ = kSlipSeconds + kSlipTurns * config.settings.command_divider / config.settings.tick_hz;
    const auto drive = static_cast<std::uint32_t>(id());
    command_id_ = {own_.can_prefix << 16U | 0x8000U | drive, true};
    const std::uint32_t reply = own_.can_prefix << 16U | drive << 8U;
    reply_id_ = {reply, reply > 0x7FFU};
  }

  std::uint64_t said(const CanFrame& frame) override {
    if (frame.id != command_id_) return 0;
    if (frame.type != FrameType::kData || !frame.fd) refuse(frame, "a command frame of another form");
    const auto written = numbersOf(frame, 0x00);
    if (!written) refuse(frame, "subframes that make no sense");
    for (const auto& [reg, value] : *written) {
      const bool ours = reg == kMode || (reg >= kPlace && reg <= kIntegralLimit);
      if (!ours) refuse(frame, "a register that rc10d has no business with");
    }
    if (const auto mode = written->find(kMode); mode != written->end())
      saidMode(frame, mode->second, *written);
    return kAllBytes;
  }

  // With another source, or a standard id, or to every drive.
  [[nodiscard]] bool obeys(const CanFrame& frame) const override {
    const auto destination = frame.id.value & 0xFFU;
    return destination == static_cast<std::uint32_t>(id()) || destination == 0x7F;
  }
  // A write of a register; subframes that it does not know end a frame.
  [[nodiscard]] bool changedBy(const CanFrame& frame) const override {
    const auto written = numbersOf(frame, 0x00);
    return obeys(frame) && written && !written->empty();
  }
  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    if (frame.id != command_id_ || frame.type != FrameType::kData || frame.length == 0) return false;
    const auto written = numbersOf(frame, 0x00);
    if (!written || frame.data[0] > 0x0F) return false;
    const auto mode = written->find(kMode);
    return mode != written->end() && mode->second != kStopped;
  }

  bool heard(const CanFrame& frame) override {
    if (frame.id != reply_id_ || frame.type != FrameType::kData) return false;
    const auto told = numbersOf(frame, 0x20);
    if (!told) return false;
    const auto number = [&told](std::uint32_t reg) {
      const auto found = told->find(reg);
      return found == told->end() ? kUnsaid : found->second;
    };
    const double mode = number(kMode);
    // Stopped, with a fault, or stopped by its watchdog.
    if (mode == 0.0 || mode == 1.0 || mode == 11.0) told_.law = Told::Law::kOff;
    if (!std::isfinite(number(0x001)) || !std::isfinite(number(0x002))) return false;
    place_rev_ = number(0x001);
    measured_.velocity_rpm = number(0x002) * 60.0 / perOutput();
    if (std::isfinite(number(0x00E))) measured_.temperature_c = number(0x00E);
    return true;
  }

  [[nodiscard]] Told told() const override { return told_; }

 private:
  using Numbers = std::map<std::uint32_t, double>;

  void saidMode(const CanFrame& frame, double mode, const Numbers& written) {
    const auto number = [&written](std::uint32_t reg, double otherwise) {
      const auto found = written.find(reg);
      return found == written.end() || std::isnan(found->second) ? otherwise : found->second;
    };
    told_ = {.effort_step = 1e-6, .velocity_step_rpm = 1e-6};
    if (mode == kStopped) return;
    if (mode == kBrake) {
      told_.law = Told::Law::kBrake;
      return;
    }
    if (mode != kPosition) refuse(frame, "a mode that rc10d has no business with");
    if (number(kTimeout, kUnsaid) != static_cast<double>(own_.watchdog_ms) * 1e-3)
      refuse(frame, "without its watchdog");
    // Each frame starts from the defaults: full gains.
    told_.stiff = number(kStiffness, 1.0) > 0.0;
    told_.damped = number(kDamping, 1.0) > 0.0;
    told_.effort = effortOfNm(number(kTorque, 0.0));
    told_.velocity_rpm = number(kVelocity, 0.0) * 60.0 / perOutput();
    told_.most_effort = std::fabs(effortOfNm(number(kMostTorque, kUnsaid)));
    const double most_rev_s = number(kMostVelocity, kUnsaid);
    if (most_rev_s >= 0.0) told_.most_rpm = std::fabs(most_rev_s * 60.0 / perOutput());
    if (!told_.stiff && !told_.damped) {
      told_.law = Told::Law::kEffort;
      told_.velocity_rpm = 0.0;
    } else if (!told_.stiff) {
      told_.law = Told::Law::kSpring;
      told_.sum = kUnsaid;  // the gain is in the drive
    } else if (most_rev_s < 0.0) {
      told_.law = Told::Law::kVelocity;  // to a point that moves with it
      told_.ahead_deg =
          std::remainder(number(kPlace, place_rev_) - place_rev_, kRoundRev) * 360.0 / perOutput();
      told_.most_ahead_deg =
          (kSlipRev + std::fabs(number(kVelocity, 0.0)) * slip_s_) * 360.0 / std::fabs(perOutput());
      told_.ahead_step_deg = (1e-6 + std::fabs(place_rev_) * 1e-6) * 360.0 / std::fabs(perOutput());
    } else {
      told_.law = Told::Law::kAngle;
      told_.ahead_deg = (number(kPlace, place_rev_) - place_rev_) * 360.0 / perOutput();
      told_.ahead_step_deg = std::fabs(place_rev_) * 1e-4 / std::fabs(perOutput());
    }
  }

  // The registers of the subframes of one kind (0x00: written, 0x20: answered); nothing: malformed.
  static std::optional<Numbers> numbersOf(const CanFrame& frame, std::uint8_t wanted) {
    constexpr std::array<std::size_t, 4> kBytes{1, 2, 4, 4};
    Numbers numbers;
    std::size_t at = 0;
    const auto varuint = [&] {
      std::uint32_t value = 0;
      for (unsigned shift = 0; at < frame.length && shift < 28; shift += 7) {
        const std::uint8_t byte = frame.data[at++];
        value |= static_cast<std::uint32_t>(byte & 0x7FU) << shift;
        if (byte < 0x80) break;
      }
      return value;
    };
    while (at < frame.length) {
      const std::uint8_t head = frame.data[at++];
      if (head == 0x50) continue;
      if (head >= 0x30) {
        if (head > 0x31) return std::nullopt;
        (void)varuint();
        (void)varuint();
        continue;
      }
      const auto kind = static_cast<std::uint8_t>(head & 0xF0U);
      const std::size_t type = head >> 2U & 3U;
      std::uint32_t count = head & 3U;
      if (count == 0) count = varuint();
      std::uint32_t reg = varuint();
      if (kind == 0x10) continue;  // read: there are no values
      for (; count > 0; --count, ++reg) {
        if (at + kBytes[type] > frame.length) return std::nullopt;
        const std::uint32_t raw = littleEndian(frame, at, kBytes[type]);
        at += kBytes[type];
        if (kind == wanted) numbers[reg] = numberOf(reg, type, raw);
      }
    }
    return numbers;
  }

  [[nodiscard]] static double numberOf(std::uint32_t reg, std::size_t type, std::uint32_t raw) {
    const auto scales = scalesOf(reg);
    switch (type) {
      case 0: return raw == 0x80U ? kUnsaid : static_cast<std::int8_t>(raw) * scales[0];
      case 1: return raw == 0x8000U ? kUnsaid : int16Of(raw) * scales[1];
      case 2: return raw == 0x8000'0000U ? kUnsaid : int32Of(raw) * scales[2];
      default: return static_cast<double>(floatOf(raw));
    }
  }

  MoteusSettings own_;
  CanId command_id_;
  CanId reply_id_;
  double slip_s_ = 0.0;
  double place_rev_ = 0.0;
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeMoteusWire(const MotorConfig& config) {
  return std::make_unique<MoteusWire>(config);
}

}  // namespace rc10::test
