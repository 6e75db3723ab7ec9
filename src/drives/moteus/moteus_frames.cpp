#include "drives/moteus/moteus_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bus/byte_order.hpp"

namespace rc10::moteus {
namespace {

constexpr std::uint8_t kNop = 0x50;
constexpr std::uint8_t kWriteError = 0x30;
constexpr std::uint8_t kReadError = 0x31;
constexpr std::uint32_t kMaxCount = 64;  // more registers than a frame has bytes

constexpr std::array<std::size_t, 4> kBytes{1, 2, 4, 4};

// Scale of an 8, 16 and 32 bit integer: docs/protocol/registers.md, "Mappings".
struct Scale {
  double int8, int16, int32;
};
constexpr Scale kCurrentA{1.0, 0.1, 0.001};
constexpr Scale kTorqueNm{0.5, 0.01, 0.001};
constexpr Scale kVolts{0.5, 0.1, 0.001};
constexpr Scale kCelsius{1.0, 0.1, 0.001};
constexpr Scale kSeconds{0.01, 0.001, 1e-6};
constexpr Scale kRevolutions{0.01, 1e-4, 1e-5};
constexpr Scale kRevPerS{0.1, 2.5e-4, 1e-5};
constexpr Scale kRevPerS2{0.05, 1e-3, 1e-5};
constexpr Scale kWatts{10.0, 0.05, 1e-4};
constexpr Scale kShare{1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0};
constexpr Scale kNumber{1.0, 1.0, 1.0};

[[nodiscard]] const Scale& scaleOf(Register reg) noexcept {
  using enum Register;
  switch (reg) {
    case kPosition:
    case kAbsolutePosition:
    case kCommandPosition:
    case kStopPosition:
    case kStayWithinLower:
    case kStayWithinUpper: return kRevolutions;
    case kVelocity:
    case kCommandVelocity:
    case kVoltageFocThetaRate:
    case kVelocityLimit: return kRevPerS;
    case kAccelerationLimit: return kRevPerS2;
    case kTorque:
    case kCommandTorque:
    case kMaxTorque:
    case kStayWithinTorque:
    case kStayWithinMaxTorque: return kTorqueNm;
    case kQCurrent:
    case kDCurrent:
    case kCommandQCurrent:
    case kCommandDCurrent:
    case kFixedCurrent: return kCurrentA;
    case kVoltage:
    case kVoltagePhaseA:
    case kVoltagePhaseB:
    case kVoltagePhaseC:
    case kVoltageFoc:
    case kVoltageDqD:
    case kVoltageDqQ:
    case kFixedVoltage: return kVolts;
    case kTemperature:
    case kMotorTemperature: return kCelsius;
    case kTimeout:
    case kStayWithinTimeout: return kSeconds;
    case kPower: return kWatts;
    case kPwmPhaseA:
    case kPwmPhaseB:
    case kPwmPhaseC:
    case kVoltageFocTheta:
    case kKpScale:
    case kKdScale:
    case kIlimitScale:
    case kStayWithinKpScale:
    case kStayWithinKdScale:
    case kStayWithinIlimitScale: return kShare;
    case kTrajectoryComplete:
    case kIgnorePositionBounds:
    case kStayWithinIgnorePositionBounds:
    case kMode:
    case kHomeState:
    case kFault:
    case kMilliseconds:
    case kRegisterMapVersion: break;
  }
  return kNumber;
}

// Values written to the drive are rounded. The drive truncates those of its replies, in single precision:
// 0.063 s are 62 ms (mjbots/moteus, fw/moteus_controller.cc, ScaleMapping).
constexpr std::uint8_t kReply = 0x20;

/// Symmetric, as the drive does it: the lowest integer is "not a number".
template <typename T>
[[nodiscard]] T toCounts(double value, double scale, std::uint8_t kind) noexcept {
  if (!std::isfinite(value)) return std::numeric_limits<T>::min();
  constexpr auto kMax = static_cast<double>(std::numeric_limits<T>::max());
  const double counts =
      kind == kReply ? std::trunc(static_cast<double>(static_cast<float>(value) / static_cast<float>(scale)))
                     : std::round(value / scale);
  return static_cast<T>(std::clamp(counts, -kMax, kMax));
}

template <typename T>
[[nodiscard]] double fromCounts(T counts, double scale) noexcept {
  if (counts == std::numeric_limits<T>::min()) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(counts) * scale;
}

[[nodiscard]] float toFloat(double value) noexcept {
  if (std::isnan(value)) return std::numeric_limits<float>::quiet_NaN();
  constexpr auto kMax = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(std::clamp(value, -kMax, kMax));
}

}  // namespace

double scaleOf(Register reg, Type type) noexcept {
  const Scale& scale = scaleOf(reg);
  switch (type) {
    case Type::kInt8: return scale.int8;
    case Type::kInt16: return scale.int16;
    case Type::kInt32: return scale.int32;
    case Type::kFloat: break;
  }
  return 1.0;
}

Writer::Writer(CanId id, bool bit_rate_switch) noexcept {
  frame_.id = id;
  frame_.fd = true;
  frame_.bit_rate_switch = bit_rate_switch;
}

bool Writer::header(std::uint8_t kind, Type type, Register first, std::uint32_t count,
                    std::size_t value_bytes) noexcept {
  auto number = static_cast<std::uint32_t>(first);
  const std::size_t number_bytes = number < 0x80U ? 1 : 2;  // no register has more than 14 bits
  const std::size_t count_bytes = count > 3 ? 1 : 0;        // no frame has more than 127 registers
  if (used_ + 1 + count_bytes + number_bytes + value_bytes > kMaxPayload) return false;
  const auto base = static_cast<std::uint8_t>(kind | static_cast<unsigned>(type) << 2U);
  frame_.data[used_++] = static_cast<std::uint8_t>(count > 3 ? base : base | count);
  if (count > 3) frame_.data[used_++] = static_cast<std::uint8_t>(count);
  if (number_bytes == 2) {
    frame_.data[used_++] = static_cast<std::uint8_t>(0x80U | (number & 0x7FU));
    number >>= 7U;
  }
  frame_.data[used_++] = static_cast<std::uint8_t>(number);
  return true;
}

Writer& Writer::put(std::uint8_t kind, Type type, Register first, std::span<const double> values) noexcept {
  const std::size_t bytes = kBytes[static_cast<std::size_t>(type)];
  if (!header(kind, type, first, static_cast<std::uint32_t>(values.size()), bytes * values.size())) {
    return *this;
  }
  auto reg = static_cast<std::uint32_t>(first);
  for (const double value : values) {
    const double scale = scaleOf(static_cast<Register>(reg++), type);
    switch (type) {
      case Type::kInt8:
        writeLittleEndian(frame_.data, used_, toCounts<std::int8_t>(value, scale, kind));
        break;
      case Type::kInt16:
        writeLittleEndian(frame_.data, used_, toCounts<std::int16_t>(value, scale, kind));
        break;
      case Type::kInt32:
        writeLittleEndian(frame_.data, used_, toCounts<std::int32_t>(value, scale, kind));
        break;
      case Type::kFloat: writeLittleEndian(frame_.data, used_, toFloat(value)); break;
    }
    used_ += bytes;
  }
  return *this;
}

Writer& Writer::error(bool of_read, Register reg, std::uint8_t code) noexcept {
  const auto number = static_cast<std::uint32_t>(reg);
  const std::size_t number_bytes = number < 0x80U ? 1 : 2;
  if (used_ + 2 + number_bytes > kMaxPayload) return *this;
  frame_.data[used_++] = of_read ? kReadError : kWriteError;
  if (number_bytes == 2) frame_.data[used_++] = static_cast<std::uint8_t>(0x80U | (number & 0x7FU));
  frame_.data[used_++] = static_cast<std::uint8_t>(number_bytes == 2 ? number >> 7U & 0x7FU : number);
  frame_.data[used_++] = code & 0x7FU;
  return *this;
}

Writer& Writer::read(Type type, Register first, std::uint32_t count) noexcept {
  (void)header(0x10, type, first, count, 0);
  return *this;
}

CanFrame Writer::frame() const noexcept {
  CanFrame frame = frame_;
  frame.length = roundUpFdLength(used_);
  for (std::size_t i = used_; i < frame.length; ++i) frame.data[i] = kNop;
  return frame;
}

bool Reader::readNumber(std::uint32_t& number) noexcept {
  number = 0;
  // 28 bits are more than any register or count has.
  for (std::uint32_t shift = 0; shift < 28; shift += 7) {
    if (at_ >= payload_.size()) return false;
    const std::uint8_t byte = payload_[at_++];
    number |= static_cast<std::uint32_t>(byte & 0x7FU) << shift;
    if ((byte & 0x80U) == 0) return true;
  }
  return false;
}

Reader::Step Reader::begin() noexcept {
  while (at_ < payload_.size() && payload_[at_] == kNop) ++at_;
  if (at_ >= payload_.size()) return Step::kEnd;
  const std::uint8_t head = payload_[at_++];
  if (head == kWriteError || head == kReadError) {
    kind_ = Item::Kind::kError;
    left_ = 1;
    return readNumber(register_) ? Step::kItem : Step::kMalformed;
  }
  if (head >= 0x30) return Step::kMalformed;
  constexpr std::array kKinds{Item::Kind::kWrite, Item::Kind::kRead, Item::Kind::kReply};
  kind_ = kKinds[head >> 4U];
  type_ = static_cast<Type>((head >> 2U) & 3U);
  left_ = head & 3U;
  if (left_ == 0 && (!readNumber(left_) || left_ == 0 || left_ > kMaxCount)) return Step::kMalformed;
  return readNumber(register_) ? Step::kItem : Step::kMalformed;
}

Reader::Step Reader::next(Item& item) noexcept {
  if (left_ == 0) {
    if (const Step begun = begin(); begun != Step::kItem) return begun;
  }
  item = {.kind = kind_, .type = type_, .reg = static_cast<Register>(register_), .value = 0.0, .left = left_};
  --left_;
  ++register_;
  if (kind_ == Item::Kind::kRead) return Step::kItem;
  if (kind_ == Item::Kind::kError) {
    std::uint32_t code = 0;
    if (!readNumber(code)) return Step::kMalformed;
    item.value = code;
    return Step::kItem;
  }
  const std::size_t bytes = kBytes[static_cast<std::size_t>(type_)];
  if (payload_.size() - at_ < bytes) return Step::kMalformed;
  const double scale = scaleOf(item.reg, type_);
  switch (type_) {
    case Type::kInt8: item.value = fromCounts(readLittleEndian<std::int8_t>(payload_, at_), scale); break;
    case Type::kInt16: item.value = fromCounts(readLittleEndian<std::int16_t>(payload_, at_), scale); break;
    case Type::kInt32: item.value = fromCounts(readLittleEndian<std::int32_t>(payload_, at_), scale); break;
    case Type::kFloat: item.value = static_cast<double>(readLittleEndian<float>(payload_, at_)); break;
  }
  at_ += bytes;
  return Step::kItem;
}

}  // namespace rc10::moteus
