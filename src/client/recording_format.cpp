#include "client/recording_format.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "app/event_code.hpp"
#include "app/fault_code.hpp"
#include "app/vocabulary.hpp"
#include "blackbox/format.hpp"
#include "client/json_line.hpp"
#include "client/recording_words.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

using namespace blackbox;

template <typename T>
struct Shape {
  static constexpr std::size_t kBytes = sizeof(T);
  static constexpr std::size_t kCount = 1;
  static std::string type() {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    const char* kind = std::is_floating_point_v<T> ? "f" : std::is_signed_v<T> ? "i" : "u";
    return kind + std::to_string(8 * sizeof(T));
  }
};
template <std::size_t N>
struct Shape<link::Text<N>> {
  static constexpr std::size_t kBytes = N;
  static constexpr std::size_t kCount = 1;
  static std::string type() { return "text"; }
};
template <typename T, std::size_t N>
struct Shape<std::array<T, N>> {
  static constexpr std::size_t kBytes = Shape<T>::kBytes;
  static constexpr std::size_t kCount = N;
  static std::string type() { return Shape<T>::type(); }
};

template <typename T>
[[nodiscard]] Json fieldAt(std::size_t offset) {
  return {
      {"at", offset}, {"type", Shape<T>::type()}, {"bytes", Shape<T>::kBytes}, {"count", Shape<T>::kCount}};
}

#define RC10_PLACE(Struct, field) \
  { #field, fieldAt<decltype(Struct::field)>(offsetof(Struct, field)) }

[[nodiscard]] Json motorFields() {
  Json fields{RC10_PLACE(Motor, target), RC10_PLACE(Motor, target_shaped)};
  const Motor motor;
  visitReadings(
      [&](std::string_view name, const auto& field) {
        const auto* const at = reinterpret_cast<const std::byte*>(&field);
        const auto offset = static_cast<std::size_t>(at - reinterpret_cast<const std::byte*>(&motor));
        fields[std::string(name)] = fieldAt<std::remove_cvref_t<decltype(field)>>(offset);
      },
      motor);
  fields.update({RC10_PLACE(Motor, command_value), RC10_PLACE(Motor, limits), RC10_PLACE(Motor, fault),
                 RC10_PLACE(Motor, feedback_age_us), RC10_PLACE(Motor, feedback_age_at_use_us),
                 RC10_PLACE(Motor, command_age_us), RC10_PLACE(Motor, stop_cause)});
  return fields;
}

[[nodiscard]] Json structuresJson() {
  const auto structure = [](std::size_t bytes, Json fields) {
    return Json{{"bytes", bytes}, {"fields", std::move(fields)}};
  };
  Json json;
  json["header"] = structure(
      sizeof(Header),
      {RC10_PLACE(Header, version), RC10_PLACE(Header, pid), RC10_PLACE(Header, file_bytes),
       RC10_PLACE(Header, ring_offset), RC10_PLACE(Header, ring_bytes), RC10_PLACE(Header, history_offset),
       RC10_PLACE(Header, history_bytes), RC10_PLACE(Header, start_mono_ns), RC10_PLACE(Header, rate_hz),
       RC10_PLACE(Header, bus_count), RC10_PLACE(Header, motor_count), RC10_PLACE(Header, module_count),
       RC10_PLACE(Header, robot), RC10_PLACE(Header, program_version), RC10_PLACE(Header, config_hash),
       RC10_PLACE(Header, cause)});
  json["bus_info"] = structure(sizeof(BusInfo), {RC10_PLACE(BusInfo, name), RC10_PLACE(BusInfo, interface)});
  json["motor_info"] =
      structure(sizeof(MotorInfo),
                {RC10_PLACE(MotorInfo, name), RC10_PLACE(MotorInfo, model), RC10_PLACE(MotorInfo, bus)});
  json["module_info"] =
      structure(sizeof(ModuleInfo), {RC10_PLACE(ModuleInfo, name), RC10_PLACE(ModuleInfo, input_count),
                                     RC10_PLACE(ModuleInfo, event_count), RC10_PLACE(ModuleInfo, inputs),
                                     RC10_PLACE(ModuleInfo, events)});
  json["control"] =
      structure(sizeof(Control), {RC10_PLACE(Control, head), RC10_PLACE(Control, dropped),
                                  RC10_PLACE(Control, tail), RC10_PLACE(Control, oldest),
                                  RC10_PLACE(Control, wall_offset_ns), RC10_PLACE(Control, ended)});
  json["frame"] = structure(sizeof(Frame), {RC10_PLACE(Frame, data)});
  json["command"] =
      structure(sizeof(Command), {RC10_PLACE(Command, client), RC10_PLACE(Command, session),
                                  RC10_PLACE(Command, deadline_ns), RC10_PLACE(Command, priority)});
  json["setpoint"] = structure(
      sizeof(Setpoint),
      {RC10_PLACE(Setpoint, value), RC10_PLACE(Setpoint, velocity_ff_rpm), RC10_PLACE(Setpoint, torque_ff_nm),
       RC10_PLACE(Setpoint, stiffness_nm_per_rad), RC10_PLACE(Setpoint, damping_nms_per_rad)});
  json["order"] = structure(sizeof(Order),
                            {RC10_PLACE(Order, motors), RC10_PLACE(Order, value), RC10_PLACE(Order, client)});
  json["event"] = structure(sizeof(Event),
                            {RC10_PLACE(Event, value), RC10_PLACE(Event, extra), RC10_PLACE(Event, client)});
  json["motor"] = structure(sizeof(Motor), motorFields());
  json["robot"] = structure(
      sizeof(Robot), {RC10_PLACE(Robot, tick), RC10_PLACE(Robot, missed_ticks), RC10_PLACE(Robot, estops)});
  json["bus"] = structure(
      sizeof(Bus), {RC10_PLACE(Bus, rx_frames), RC10_PLACE(Bus, tx_frames), RC10_PLACE(Bus, tx_dropped),
                    RC10_PLACE(Bus, error_frames), RC10_PLACE(Bus, tec), RC10_PLACE(Bus, rec)});
  json["signals"] = structure(sizeof(Signals), {RC10_PLACE(Signals, client), RC10_PLACE(Signals, session),
                                                RC10_PLACE(Signals, deadline_ns),
                                                RC10_PLACE(Signals, priority), RC10_PLACE(Signals, values)});
  return json;
}

#undef RC10_PLACE

[[nodiscard]] Json kindsJson() {
  std::array<const char*, 10> kinds{};
  kinds.fill("");
  const auto is = [&kinds](RecordType type, const char* name) {
    kinds[static_cast<std::size_t>(type)] = name;
  };
  is(Frame::kType, "frame");
  is(Command::kType, "command");
  is(Setpoint::kType, "setpoint");
  is(Order::kType, "order");
  is(Event::kType, "event");
  is(Motor::kType, "motor");
  is(Robot::kType, "robot");
  is(Bus::kType, "bus");
  is(Signals::kType, "signals");
  return kinds;
}

[[nodiscard]] Json faultsJson() {
  Json faults = Json::object();
  for (std::int32_t fault = 1; fault <= static_cast<std::int32_t>(FaultCode::kDriveOther); ++fault)
    faults[std::to_string(fault)] = link::faultText(fault);
  return faults;
}

[[nodiscard]] Json lengthsJson() {
  Json lengths = Json::array();
  for (std::uint8_t code = 0; code < 16; ++code) lengths.push_back(payloadBytes(code | kFrameFd));
  return lengths;
}

}  // namespace

std::string recordingFormatJson() {
  const auto table = [](std::size_t at, std::size_t count) { return Json{{"at", at}, {"count", count}}; };
  return lineOf({{"magic", std::string_view{kMagic.data(), kMagic.size()}},
                 {"version", kFormatVersion},
                 {"word", kWord},
                 {"max_file_bytes", kMaxFileBytes},
                 {"head_bytes", sizeof(FileHead)},
                 {"control_at", offsetof(FileHead, control)},
                 {"tables",
                  {{"buses", table(offsetof(Header, buses), link::kMaxBuses)},
                   {"motors", table(offsetof(Header, motors), link::kMaxMotors)},
                   {"modules", table(offsetof(Header, modules), link::kMaxModules)}}},
                 {"structures", structuresJson()},
                 {"kinds", kindsJson()},
                 {"no_source", kNoSource},
                 {"flags",
                  {{"fd", kFrameFd},
                   {"bit_rate_switch", kFrameBitRateSwitch},
                   {"sent", kFrameSent},
                   {"refused", kFrameRefused},
                   {"setpoint_skipped", kSetpointSkipped}}},
                 {"ids", {{"extended", kIdExtended}, {"remote", kIdRemote}, {"error", kIdError}}},
                 {"payload_bytes", lengthsJson()},
                 {"events",
                  {{"own_words", EventCode::kModule},
                   {"ticks_missed", EventCode::kTicksMissed},
                   {"first_module", kFirstModuleEvent},
                   {"last_module", kLastModuleEvent},
                   {"first_bus", kFirstBusEvent}}},
                 {"words",
                  {{"mode", kControlModeWords},
                   {"mode_unit", kControlModeUnits},
                   {"status", kMotorStatusWords},
                   {"robot", kRobotStatusWords},
                   {"acting", kActingWords},
                   {"stop_cause", kStopCauseWords},
                   {"condition", kConditionWords},
                   {"bus", kBusStateWords},
                   {"command_unit", kCommandUnitWords},
                   {"limit", kLimitWords},
                   {"severity", kSeverityWords},
                   {"verdict", kVerdictWords},
                   {"operation", kOperationWords}}},
                 {"faults", faultsJson()}});
}

}  // namespace rc10::client
