#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "bus/can_frame.hpp"

namespace rc10::moteus {

// The register protocol of moteus: a payload is a row of subframes, each of which writes, reads or answers
// some registers in a row. Sources: mjbots/moteus@db1a762 docs/protocol/{can,registers}.md,
// fw/moteus_controller.cc.

enum class Register : std::uint32_t {
  kMode = 0x000,
  kPosition = 0x001,
  kVelocity = 0x002,
  kTorque = 0x003,
  kQCurrent = 0x004,
  kDCurrent = 0x005,
  kAbsolutePosition = 0x006,
  kPower = 0x007,
  kMotorTemperature = 0x00A,
  kTrajectoryComplete = 0x00B,
  kHomeState = 0x00C,
  kVoltage = 0x00D,
  kTemperature = 0x00E,
  kFault = 0x00F,
  kPwmPhaseA = 0x010,
  kPwmPhaseB = 0x011,
  kPwmPhaseC = 0x012,
  kVoltagePhaseA = 0x014,
  kVoltagePhaseB = 0x015,
  kVoltagePhaseC = 0x016,
  kVoltageFocTheta = 0x018,
  kVoltageFoc = 0x019,
  kVoltageDqD = 0x01A,
  kVoltageDqQ = 0x01B,
  kCommandQCurrent = 0x01C,
  kCommandDCurrent = 0x01D,
  kVoltageFocThetaRate = 0x01E,
  kCommandPosition = 0x020,
  kCommandVelocity = 0x021,
  kCommandTorque = 0x022,
  kKpScale = 0x023,
  kKdScale = 0x024,
  kMaxTorque = 0x025,
  kStopPosition = 0x026,
  kTimeout = 0x027,
  kVelocityLimit = 0x028,
  kAccelerationLimit = 0x029,
  kFixedVoltage = 0x02A,
  kIlimitScale = 0x02B,
  kFixedCurrent = 0x02C,
  kIgnorePositionBounds = 0x02D,
  kStayWithinLower = 0x040,
  kStayWithinUpper = 0x041,
  kStayWithinTorque = 0x042,
  kStayWithinKpScale = 0x043,
  kStayWithinKdScale = 0x044,
  kStayWithinMaxTorque = 0x045,
  kStayWithinTimeout = 0x046,
  kStayWithinIlimitScale = 0x047,
  kStayWithinIgnorePositionBounds = 0x048,
  kMilliseconds = 0x070,
  kRegisterMapVersion = 0x102,
};

enum class Mode : std::uint8_t {
  kStopped = 0,
  kFault = 1,
  kEnabling = 2,
  kCalibrating = 3,
  kCalibrated = 4,
  kPwm = 5,
  kVoltage = 6,
  kVoltageFoc = 7,
  kVoltageDq = 8,
  kCurrent = 9,
  kPosition = 10,
  kTimeout = 11,  ///< Its watchdog: latched until a stop.
  kZeroVelocity = 12,
  kStayWithin = 13,
  kMeasureInductance = 14,
  kBrake = 15,
};

/// Type of a value on the wire. Integers count the unit of their register; their lowest value is NaN.
enum class Type : std::uint8_t { kInt8, kInt16, kInt32, kFloat };

/// Size of one count, in rev, rev/s, rev/s², N·m, A, V, °C, s, or 1.
[[nodiscard]] double scaleOf(Register reg, Type type) noexcept;

/// The id of what the host (source 0) sends to a drive, with the bit that asks for an answer.
[[nodiscard]] constexpr CanId queryId(std::uint32_t prefix, std::uint32_t id) noexcept {
  return {prefix << 16U | 0x8000U | id, true};
}
/// The id of the answer. Standard where it fits into 11 bits: the documents say 15, the firmware (and the
/// length of an id) says 11.
[[nodiscard]] constexpr CanId replyId(std::uint32_t prefix, std::uint32_t id) noexcept {
  const std::uint32_t value = prefix << 16U | id << 8U;
  return {value, value > kStandardIdMask};
}

/// Writes subframes into a frame. 64 bytes are the caller's duty: what is too much is left out.
class Writer {
 public:
  Writer(CanId id, bool bit_rate_switch) noexcept;

  /// Values in units, from this register on. Integers saturate; not a number is "not a number" there too.
  Writer& write(Type type, Register first, std::initializer_list<double> values) noexcept {
    return put(0x00, type, first, {values.begin(), values.size()});
  }
  Writer& reply(Type type, Register first, std::initializer_list<double> values) noexcept {
    return reply(type, first, std::span<const double>{values.begin(), values.size()});
  }
  Writer& reply(Type type, Register first, std::span<const double> values) noexcept {
    return put(0x20, type, first, values);
  }
  /// Error subframe about one register, as a drive answers a read or a write. Codes: 1 unknown, 2 read-only.
  Writer& error(bool of_read, Register reg, std::uint8_t code) noexcept;
  Writer& read(Type type, Register first, std::uint32_t count = 1) noexcept;
  /// Padded with NOP to a length that CAN FD has.
  [[nodiscard]] CanFrame frame() const noexcept;

 private:
  Writer& put(std::uint8_t kind, Type type, Register first, std::span<const double> values) noexcept;
  [[nodiscard]] bool header(std::uint8_t kind, Type type, Register first, std::uint32_t count,
                            std::size_t value_bytes) noexcept;

  CanFrame frame_;
  std::size_t used_ = 0;
};

/// One register of a subframe.
struct Item {
  enum class Kind : std::uint8_t { kWrite, kRead, kReply, kError };
  Kind kind = Kind::kWrite;
  Type type = Type::kInt8;
  Register reg = Register::kMode;
  double value = 0.0;      ///< In units; kError: the code; kRead: 0.
  std::uint32_t left = 1;  ///< Registers of its subframe, from this one on.
};

/// Takes a payload apart, register by register.
class Reader {
 public:
  enum class Step : std::uint8_t { kItem, kEnd, kMalformed };

  explicit Reader(std::span<const std::uint8_t> payload) noexcept : payload_(payload) {}
  /// The next register; `item` is valid after kItem.
  [[nodiscard]] Step next(Item& item) noexcept;

 private:
  [[nodiscard]] bool readNumber(std::uint32_t& number) noexcept;
  [[nodiscard]] Step begin() noexcept;

  std::span<const std::uint8_t> payload_;
  std::size_t at_ = 0;
  std::uint32_t left_ = 0;  // registers of the present subframe
  std::uint32_t register_ = 0;
  Item::Kind kind_ = Item::Kind::kWrite;
  Type type_ = Type::kInt8;
};

}  // namespace rc10::moteus
