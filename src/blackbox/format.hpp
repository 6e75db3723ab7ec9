#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "link/link_protocol.hpp"

/// The black box: a file of fixed size that holds the last minute. Host byte order; written and read by the
/// same build or one with the same kFormatVersion.
///
/// Everything that happens is one stream of records, and a position is a number of bytes since the start of
/// the recording. The stream lies in two rings of the file: [tail, head) in the hand-off ring, which the
/// scheduler thread writes, and [oldest, tail) in the history, to which the io thread moves it, byte for
/// byte. One word, `tail`, says where one ends and the other begins: a process that is killed at any moment
/// leaves a whole recording.
namespace rc10::blackbox {

inline constexpr std::array<char, 8> kMagic{'R', 'C', '1', '0', 'B', 'O', 'X', '1'};
inline constexpr std::uint32_t kFormatVersion = 3;
/// Records are a whole number of these.
inline constexpr std::size_t kWord = 8;
inline constexpr std::size_t kMaxRecordBytes = 255 * kWord;
/// The largest file that `blackbox_mib` allows.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{256} << 20U;

struct BusInfo {
  link::Name name;
  link::Name interface;  ///< Empty: simulated.
};

struct MotorInfo {
  link::Name name;
  link::Name model;
  std::uint32_t bus = 0;
};

inline constexpr std::size_t kMaxModuleEvents = 16;

struct ModuleInfo {
  link::Name name;
  std::uint32_t input_count = 0;
  std::uint32_t event_count = 0;
  std::array<link::Name, link::kMaxSignals> inputs;
  std::array<link::Text<96>, kMaxModuleEvents> events;  ///< Words of its events, by their numbers.
};

/// Written once, at the start.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kFormatVersion;
  std::int32_t pid = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t ring_offset = 0;
  std::uint64_t ring_bytes = 0;  ///< A power of two.
  std::uint64_t history_offset = 0;
  std::uint64_t history_bytes = 0;
  std::int64_t start_mono_ns = 0;  ///< CLOCK_MONOTONIC
  std::uint32_t rate_hz = 0;
  std::uint32_t bus_count = 0;
  std::uint32_t motor_count = 0;
  std::uint32_t module_count = 0;
  link::Name robot;
  link::Text<32> program_version;
  link::Text<72> config_hash;  ///< SHA-256 of the configuration file, in hexadecimal digits.
  link::Text<32> cause;        ///< Cause of a copy. Empty: not a copy.
  std::array<BusInfo, link::kMaxBuses> buses;
  std::array<MotorInfo, link::kMaxMotors> motors;
  std::array<ModuleInfo, link::kMaxModules> modules;
};

/// Written all the time, by std::atomic_ref. Each word has one writer.
struct Control {
  alignas(64) std::uint64_t head = 0;   ///< Scheduler: the end of the stream.
  std::uint64_t dropped = 0;            ///< Scheduler: records for which the hand-off ring had no room.
  alignas(64) std::uint64_t tail = 0;   ///< io thread: what is before is in the history.
  std::uint64_t oldest = 0;             ///< io thread: start of the oldest record that is still there.
  std::int64_t wall_offset_ns = 0;      ///< io thread: CLOCK_REALTIME - CLOCK_MONOTONIC.
  alignas(64) std::uint64_t ended = 0;  ///< Main thread: 1 when rc10d has stopped in good order.
};

/// The beginning of the file.
struct FileHead {
  Header header;
  Control control;
};
static_assert(std::is_trivially_copyable_v<FileHead> && std::is_standard_layout_v<FileHead>);

inline constexpr std::uint64_t kRingOffset = 65536;
static_assert(sizeof(FileHead) <= kRingOffset);

// ---- Records

enum class RecordType : std::uint8_t {
  kFrame = 1,
  kCommand = 2,
  kSetpoint = 3,
  kOrder = 4,
  kEvent = 5,
  kMotor = 6,
  kRobot = 7,
  kBus = 8,
  kSignals = 9,
};

struct RecordHeader {
  RecordType type{};
  std::uint8_t words = 0;   ///< Size of the record, in kWord.
  std::uint8_t source = 0;  ///< Index of the motor, bus or module.
  std::uint8_t flags = 0;
  std::uint32_t id = 0;
  std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC
};
static_assert(sizeof(RecordHeader) == 16);

inline constexpr std::uint8_t kNoSource = 0xFF;

// Frame::header.flags; the lowest four bits are the length code (DLC).
inline constexpr std::uint8_t kFrameFd = 1U << 4U;
inline constexpr std::uint8_t kFrameBitRateSwitch = 1U << 5U;
inline constexpr std::uint8_t kFrameSent = 1U << 6U;     ///< Clear: received.
inline constexpr std::uint8_t kFrameRefused = 1U << 7U;  ///< The kernel did not take it.
// Frame::header.id, as in SocketCAN's can_id.
inline constexpr std::uint32_t kIdExtended = 1U << 31U;
inline constexpr std::uint32_t kIdRemote = 1U << 30U;
inline constexpr std::uint32_t kIdError = 1U << 29U;

/// A frame on a bus. Time: received: the kernel's stamp; sent: its tick's.
struct Frame {
  static constexpr auto kType = RecordType::kFrame;
  RecordHeader header;
  std::array<std::uint8_t, 64> data{};
};

/// Fate of a message with commands, or with inputs of a module.
enum class Verdict : std::uint8_t { kApplied = 0, kExpired = 1, kNotOwner = 2 };

/// A command message that reached the scheduler; `flags` is the Verdict, `id` the number of setpoints, which
/// follow.
struct Command {
  static constexpr auto kType = RecordType::kCommand;
  RecordHeader header;
  link::Name client;
  std::uint64_t session = 0;
  std::int64_t deadline_ns = 0;
  std::int32_t priority = 0;
  std::int32_t reserved = 0;
};

inline constexpr std::uint8_t kSetpointSkipped = 1;  ///< Setpoint::header.flags

/// One setpoint of the command before it; `source` is the motor, `id` the mode. The last four are there only
/// where one is not zero.
struct Setpoint {
  static constexpr auto kType = RecordType::kSetpoint;
  RecordHeader header;
  double value = 0.0;
  float velocity_ff_rpm = 0.0F;
  float torque_ff_nm = 0.0F;
  float stiffness_nm_per_rad = 0.0F;
  float damping_nms_per_rad = 0.0F;
};
inline constexpr std::size_t kPlainSetpointBytes = offsetof(Setpoint, velocity_ff_rpm);

/// Inputs of a module that reached the scheduler; `source` is the module, `flags` the Verdict, and `id` has a
/// bit for each input that is given: their values follow in that order, and no others.
struct Signals {
  static constexpr auto kType = RecordType::kSignals;
  RecordHeader header;
  link::Name client;
  std::uint64_t session = 0;  ///< 0: from a module, which is `client`.
  std::int64_t deadline_ns = 0;
  std::int32_t priority = 0;
  std::int32_t reserved = 0;
  std::array<double, link::kMaxSignals> values{};
};
static_assert(link::kMaxSignals <= 32, "a bit each");

/// Bytes of a record with this number of inputs.
[[nodiscard]] constexpr std::size_t signalsBytes(std::size_t count) noexcept {
  return offsetof(Signals, values) + count * sizeof(double);
}

/// A request that reached the scheduler; `flags` is the Operation. `source` is 1 if it named no motor: it was
/// meant for the robot.
struct Order {
  static constexpr auto kType = RecordType::kOrder;
  RecordHeader header;
  std::array<std::uint64_t, link::kMaxMotors / 64> motors{};  ///< One bit each.
  double value = 0.0;
  link::Name client;
};

// Whose event it is, by its code (docs/lcm.md): of a module, of a bus from kFirstBusEvent on, else of a
// motor.
inline constexpr std::uint32_t kFirstModuleEvent = 108;
inline constexpr std::uint32_t kLastModuleEvent = 109;
inline constexpr std::uint32_t kFirstBusEvent = 300;

/// `id` is the code of event_t.lcm, `source` the motor, module or bus, `flags` the severity.
struct Event {
  static constexpr auto kType = RecordType::kEvent;
  RecordHeader header;
  std::int32_t value = 0;
  std::int32_t extra = 0;
  link::Name client;
};

/// State of a motor, as in motor_state_t.lcm. `flags` is the status, `id` the mode, the unit of
/// command_value in the second byte, whether the angle is referenced in the third, and in the fourth what
/// acts.
struct Motor {
  static constexpr auto kType = RecordType::kMotor;
  RecordHeader header;
  double target = 0.0;
  double target_shaped = 0.0;
  double total_angle_deg = 0.0;
  float angle_deg = 0.0F;
  float velocity_rpm = 0.0F;
  float current_a = 0.0F;
  float torque_nm = 0.0F;
  float voltage_v = 0.0F;
  float temperature_c = 0.0F;
  float command_value = 0.0F;
  std::uint32_t limits = 0;
  std::int32_t fault = 0;
  std::int32_t feedback_age_us = -1;
  std::int32_t feedback_age_at_use_us = -1;
  std::int32_t command_age_us = -1;
  std::uint32_t stop_cause = 0;
  std::uint32_t reserved = 0;
};

/// Calls visit(name, field of each holder...) for the readings of its drive that a Motor has.
template <typename Visit, typename... Holders>
constexpr void visitReadings(const Visit& visit, Holders&... holders) {
  visit(std::string_view{"total_angle_deg"}, holders.total_angle_deg...);
  visit(std::string_view{"angle_deg"}, holders.angle_deg...);
  visit(std::string_view{"velocity_rpm"}, holders.velocity_rpm...);
  visit(std::string_view{"current_a"}, holders.current_a...);
  visit(std::string_view{"torque_nm"}, holders.torque_nm...);
  visit(std::string_view{"voltage_v"}, holders.voltage_v...);
  visit(std::string_view{"temperature_c"}, holders.temperature_c...);
}

/// `flags` is the state of the robot, `source` the cause of its stop, `id` its conditions.
struct Robot {
  static constexpr auto kType = RecordType::kRobot;
  RecordHeader header;
  std::uint64_t tick = 0;
  std::uint64_t missed_ticks = 0;
  std::uint64_t estops = 0;
};

/// `source` is the bus, `flags` its state.
struct Bus {
  static constexpr auto kType = RecordType::kBus;
  RecordHeader header;
  std::uint64_t rx_frames = 0;
  std::uint64_t tx_frames = 0;
  std::uint64_t tx_dropped = 0;
  std::uint64_t error_frames = 0;
  std::int32_t tec = -1;
  std::int32_t rec = -1;
};

template <typename T>
inline constexpr bool kIsRecord = std::is_trivially_copyable_v<T> && std::is_standard_layout_v<T> &&
                                  sizeof(T) % kWord == 0 && sizeof(T) <= kMaxRecordBytes;
static_assert(kIsRecord<Frame> && kIsRecord<Command> && kIsRecord<Setpoint> && kIsRecord<Order>);
static_assert(kIsRecord<Event> && kIsRecord<Motor> && kIsRecord<Robot> && kIsRecord<Bus>);
static_assert(kIsRecord<Signals>);

inline constexpr std::array<std::size_t, 16> kPayloadLengths{0, 1,  2,  3,  4,  5,  6,  7,
                                                             8, 12, 16, 20, 24, 32, 48, 64};

/// Payload bytes of a length code, ISO 11898-1. A classic frame has at most 8.
[[nodiscard]] constexpr std::size_t payloadBytes(std::uint8_t flags) noexcept {
  const std::size_t bytes = kPayloadLengths[flags & 0x0FU];
  return (flags & kFrameFd) != 0 || bytes < 8 ? bytes : 8;
}

/// The length code of a payload of a valid length.
[[nodiscard]] constexpr std::uint8_t lengthCode(std::size_t bytes) noexcept {
  if (bytes <= 8) return static_cast<std::uint8_t>(bytes);
  std::uint8_t code = 9;
  while (code < 15 && payloadBytes(static_cast<std::uint8_t>(code | kFrameFd)) < bytes) ++code;
  return code;
}

}  // namespace rc10::blackbox
