#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "app/motor_readings.hpp"
#include "app/target.hpp"
#include "app/vocabulary.hpp"
#include "link/trace_signal.hpp"

/// The messages on rc10d's link socket (SOCK_SEQPACKET): fixed structs, one per datagram, in the
/// host's byte order. Both ends are of the same build; Hello refuses others.
namespace rc10::link {

inline constexpr std::uint32_t kProtocolVersion = 4;
inline constexpr std::size_t kMaxMotors = 128;
inline constexpr std::size_t kMaxBuses = 4;
inline constexpr std::size_t kMaxModules = 16;
inline constexpr std::size_t kMaxSignals = 32;  ///< Inputs of a module, and outputs.
inline constexpr std::size_t kMaxRefusalReasons = 16;

/// Text of fixed room, always terminated. Longer text is cut off, between two UTF-8 characters.
template <std::size_t N>
struct Text {
  std::array<char, N> chars{};

  Text() = default;
  Text(std::string_view text) noexcept { *this = text; }  // NOLINT(google-explicit-constructor)
  Text& operator=(std::string_view text) noexcept {
    chars.fill('\0');
    std::size_t size = text.size() < N ? text.size() : N - 1;
    while (size > 0 && size < text.size() && isContinuation(text[size])) --size;
    if (size > 0) std::memcpy(chars.data(), text.data(), size);
    return *this;
  }
  /// Safe on bytes from a stranger: never reads past the room.
  [[nodiscard]] std::string_view view() const noexcept { return {chars.data(), ::strnlen(chars.data(), N)}; }
  /// As comparing view() does, with a third of the instructions: a tick compares a name for each setpoint.
  [[nodiscard]] bool equals(const Text& other) const noexcept {
    return std::strncmp(chars.data(), other.chars.data(), N) == 0;
  }

 private:
  static constexpr bool isContinuation(char c) noexcept {
    return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
  }
};

using Name = Text<32>;

/// The name in the hello of rc10-lcm.
inline constexpr std::string_view kGatewayClient = "rc10-lcm";
/// The name in the first hello of rc10-web, whose other connections have the names of its pages.
inline constexpr std::string_view kWebClient = "rc10-web";

enum class MessageType : std::uint32_t {
  // client to rc10d
  kHello = 1,
  kCommand,
  kRequest,
  kSignals,
  kTraceChoice,
  // rc10d to client
  kWelcome = 100,
  kState,
  kDiagnostics,
  kEvent,
  kResponse,
  kModuleInfo,
  kModuleState,
  kTrace,
  kSighting,
};

struct Header {
  MessageType type{};
  std::uint32_t size = 0;  ///< Size of the whole message, which is also the datagram's.
};

/// Messages that a client subscribes to besides the answers to its requests.
enum Subscription : std::uint32_t {
  kStates = 1U << 0U,
  kDiagnosticsFeed = 1U << 1U,
  kEvents = 1U << 2U,
  kModules = 1U << 3U,  ///< A ModuleInfo of each after Welcome, then their states.
};

/// First message of a client. rc10d answers with Welcome, or closes.
struct Hello {
  static constexpr auto kType = MessageType::kHello;
  Header header;
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t subscriptions = 0;
  Name client;
  Text<40> token;  ///< The client has the rights of its entry of `clients` too; mostly empty.
};

struct MotorInfo {
  Name name;
  Name model;
  Name bus;
  std::int32_t id = 0;
  std::uint32_t modes = 0;  ///< Bit set by ControlMode.
};

struct Welcome {
  static constexpr auto kType = MessageType::kWelcome;
  Header header;
  std::uint32_t protocol_version = kProtocolVersion;
  std::int32_t pid = 0;
  Name robot;
  Text<32> version;
  Text<72> config_hash;  ///< SHA-256 of the configuration file, in hexadecimal digits.
  Text<256> lcm_url;
  std::int32_t rate_hz = 0;
  std::int32_t state_hz = 0;
  std::uint32_t module_count = 0;
  std::array<Name, kMaxModules> modules;
  std::uint32_t motor_count = 0;
  std::array<MotorInfo, kMaxMotors> motors;
};

/// Origin of what the gateway passes on. Of a client of the socket itself the kernel tells more.
enum class Origin : std::uint32_t {
  kElsewhere = 0,     ///< Another computer, or not known.
  kThisComputer = 1,  ///< LCM on this computer.
};

/// As setpoint_t.lcm.
struct Setpoint {
  Name motor;
  Target target;
};

/// As command_t.lcm, with the time at which this host received it.
struct Command {
  static constexpr auto kType = MessageType::kCommand;
  Header header;
  Name client;
  std::uint64_t session = 0;
  std::int64_t seq = 0;
  std::int32_t priority = 0;
  std::int32_t validity_ms = 0;  ///< 0: default.
  std::int64_t received_ns = 0;  ///< CLOCK_MONOTONIC; one in the future counts as now.
  Origin origin{};
  std::uint32_t setpoint_count = 0;
  std::array<Setpoint, kMaxMotors> setpoints;
};

struct NamedValue {
  Text<48> name;
  double value = 0.0;
};
inline constexpr std::size_t kMaxValues = 16;

struct Request {
  static constexpr auto kType = MessageType::kRequest;
  Header header;
  Name client;
  std::uint64_t session = 0;
  std::int64_t seq = 0;
  std::int64_t received_ns = 0;  ///< CLOCK_MONOTONIC, and old: refused (kMaxRequestAge). 0: not known.
  Origin origin{};
  Text<32> operation;
  Text<1024> target;  ///< Motor names separated by commas; empty: all.
  std::uint32_t value_count = 0;
  std::array<NamedValue, kMaxValues> values;
};

/// As signals_t.lcm, for one module.
struct Signals {
  static constexpr auto kType = MessageType::kSignals;
  Header header;
  Name client;
  std::uint64_t session = 0;
  std::int64_t seq = 0;
  std::int32_t priority = 0;
  std::int32_t validity_ms = 0;  ///< 0: default.
  std::int64_t received_ns = 0;  ///< CLOCK_MONOTONIC; one in the future counts as now.
  Origin origin{};
  Name module;
  std::uint32_t value_count = 0;
  std::array<NamedValue, kMaxSignals> values;
};

/// Inputs and outputs of a module. Sent once, before its first state.
struct ModuleInfo {
  static constexpr auto kType = MessageType::kModuleInfo;
  Header header;
  std::uint32_t module = 0;  ///< Its place in Welcome::modules.
  Name type;
  std::uint32_t input_count = 0;
  std::uint32_t output_count = 0;
  std::array<Name, 2 * kMaxSignals> names;  ///< The inputs, then the outputs.
};

struct ModuleState {
  static constexpr auto kType = MessageType::kModuleState;
  Header header;
  std::int64_t utime = 0;
  std::int64_t mono_us = 0;
  std::int64_t tick = 0;
  std::uint32_t module = 0;
  Name owner;  ///< Client that gives its inputs; empty: none.
  std::uint32_t value_count = 0;
  std::array<double, kMaxSignals> values;  ///< Its outputs; NaN: without meaning now.
};

enum class ResponseStatus : std::uint32_t { kOk = 0, kFailed = 1, kRefused = 2 };

struct Response {
  static constexpr auto kType = MessageType::kResponse;
  Header header;
  Name client;
  std::uint64_t session = 0;
  std::int64_t seq = 0;
  ResponseStatus status{};
  Text<1024> message;
  std::uint32_t value_count = 0;
  std::array<NamedValue, kMaxValues> values;
};

/// As motor_state_t.lcm; the names are in Welcome, in the same order.
struct MotorState {
  MotorStatus status{};
  ControlMode mode{};
  CommandUnit command_unit{};
  std::uint8_t zeroed = 0;
  Acting acting{};
  StopCause stop_cause{};
  std::int32_t fault = 0;
  std::uint32_t limits = 0;
#define RC10_FIELD(type, name, initial) type name = initial;
  RC10_MOTOR_READINGS(RC10_FIELD)
#undef RC10_FIELD
  Name owner;
  Name stopped_by;
};

struct State {
  static constexpr auto kType = MessageType::kState;
  Header header;
  std::int64_t utime = 0;
  std::int64_t mono_us = 0;
  std::int64_t tick = 0;
  RobotStatus robot_state{};
  std::uint8_t realtime = 0;
  StopCause stop_cause{};
  Name stopped_by;
  std::int64_t stopped_mono_us = 0;
  std::int32_t estop_count = 0;
  std::uint32_t conditions = 0;
  std::uint32_t motor_count = 0;
  std::array<MotorState, kMaxMotors> motors;
};

/// As bus_state_t.lcm.
struct BusStatus {
  Name name;
  Name interface;
  BusState state{};
  std::int16_t tec = -1;
  std::int16_t rec = -1;
  float predicted_load = 0.0F;
  float predicted_load_worst = 0.0F;
  float measured_load = 0.0F;
  std::int64_t rx_frames = 0;
  std::int64_t rx_unmatched = 0;
  std::int64_t rx_malformed = 0;
  std::int64_t rx_foreign = 0;
  std::int64_t rx_dropped = 0;
  std::int64_t tx_frames = 0;
  std::int64_t tx_confirmed = 0;
  std::int64_t tx_dropped = 0;
  std::int64_t tx_held = 0;
  std::int64_t error_frames = 0;
  std::int64_t restarts = 0;
};

struct Percentiles {
  float p50_us = 0.0F;
  float p99_us = 0.0F;
  float p999_us = 0.0F;
  float max_us = 0.0F;
};

struct Counter {
  Text<48> name;
  std::int64_t count = 0;
};

/// As durations_t.lcm.
struct Durations {
  Text<48> name;
  std::int64_t count = 0;
  Percentiles percentiles;
};

inline constexpr std::size_t kMaxNotices = 4;
inline constexpr std::size_t kMaxCounters = 16;
inline constexpr std::size_t kMaxDurations = kMaxMotors + 32;

/// As diagnostics_t.lcm.
struct Diagnostics {
  static constexpr auto kType = MessageType::kDiagnostics;
  Header header;
  std::int64_t utime = 0;
  std::int64_t mono_us = 0;
  std::int64_t tick = 0;
  std::int32_t tick_period_us = 0;
  Percentiles wake_latency;
  Percentiles tick_duration;
  std::int64_t missed_ticks = 0;
  std::int64_t page_faults = 0;
  std::int64_t events_dropped = 0;
  std::uint32_t refusal_count = 0;
  std::array<Counter, kMaxRefusalReasons> refusals;
  std::uint32_t counter_count = 0;
  std::array<Counter, kMaxCounters> counters;
  std::uint32_t notice_count = 0;
  std::array<Text<256>, kMaxNotices> notices;
  std::uint32_t bus_count = 0;
  std::array<BusStatus, kMaxBuses> buses;
  std::uint32_t duration_count = 0;
  std::array<Durations, kMaxDurations> durations;
};

/// As event_t.lcm.
struct Event {
  static constexpr auto kType = MessageType::kEvent;
  Header header;
  std::int64_t utime = 0;
  std::int64_t mono_us = 0;
  Severity severity{};
  std::int32_t code = 0;
  Name source;
  Name client;
  Text<256> text;
};

/// The signals that this client wants of each tick; the newest choice counts, none ends it. Answered by a
/// Trace without rows, which names those that are traced.
struct TraceChoice {
  static constexpr auto kType = MessageType::kTraceChoice;
  Header header;
  std::uint32_t signal_count = 0;
  std::array<TraceSignal, kMaxTraceSignals> signals;
};

/// The chosen signals, of each tick since the last Trace: those of all clients together.
struct Trace {
  static constexpr auto kType = MessageType::kTrace;
  Header header;
  std::uint32_t signal_count = 0;
  std::uint32_t row_count = 0;
  std::int64_t dropped = 0;  ///< Ticks since the start of rc10d whose rows found no room.
  std::array<TraceSignal, kMaxTraceSignals> signals;
  std::array<TraceRow, kMaxTraceRows> rows;
};

inline constexpr std::size_t kMaxScanGuesses = 16;

/// Possible sender of the frames of a Sighting.
struct ScanGuess {
  Text<32> kind;  ///< "DJI GM6020".
  std::int32_t id = 0;
  std::uint8_t from_drive = 0;  ///< 0: another controller commands such drives.
  std::uint8_t collides = 0;    ///< `motor` is of another family: two devices have one id.
  Name motor;                   ///< The motor of the file that takes these frames; empty: none.
};

/// Frames heard under one id by a scan. Those of a request come before its Response, to clients of the
/// socket.
struct Sighting {
  static constexpr auto kType = MessageType::kSighting;
  Header header;
  Name client;  ///< As in the request, with session and seq.
  std::uint64_t session = 0;
  std::int64_t seq = 0;
  std::int64_t frames = 0;
  std::uint32_t frame_id = 0;
  std::uint8_t extended = 0;
  std::uint8_t ambiguous = 0;  ///< The guesses are of several kinds.
  Text<256> advice;            ///< Empty: there is nothing to be done.
  std::uint32_t guess_count = 0;
  std::array<ScanGuess, kMaxScanGuesses> guesses;  ///< None: no family that rc10d knows.
};

/// Bytes go in and out of these by memcpy.
template <typename Message>
inline constexpr bool kIsMessage =
    std::is_trivially_copyable_v<Message> && std::is_standard_layout_v<Message>;
static_assert(kIsMessage<Hello> && kIsMessage<Welcome> && kIsMessage<Command> && kIsMessage<Request>);
static_assert(kIsMessage<TraceChoice> && kIsMessage<Trace> && kIsMessage<Sighting>);
static_assert(kIsMessage<Signals> && kIsMessage<ModuleInfo> && kIsMessage<ModuleState>);
static_assert(kIsMessage<Response> && kIsMessage<State> && kIsMessage<Diagnostics> && kIsMessage<Event>);

}  // namespace rc10::link
