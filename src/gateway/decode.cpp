#include "gateway/convert.hpp"

#include <string_view>

#include "rc10/command_t.hpp"
#include "rc10/request_t.hpp"
#include "rc10/signals_t.hpp"

namespace rc10::gateway {
namespace {

template <std::size_t N>
void readText(WireReader& reader, link::Text<N>& text) noexcept {
  // A name that is cut off could be that of another motor.
  text = reader.text(N - 1);
}

WireReader open(std::span<const std::byte> bytes, std::int64_t fingerprint) noexcept {
  WireReader reader(bytes);
  if (bytes.size() > kMaxIncoming) reader.spoil(Defect::kTooLarge);
  const auto received = reader.number<std::int64_t>();
  if (received != fingerprint) reader.spoil(Defect::kOtherDefinitions);
  return reader;
}

void readSetpoint(WireReader& reader, link::Setpoint& setpoint) noexcept {
  readText(reader, setpoint.motor);
  setpoint.target.mode =
      ControlMode{reader.number<std::uint8_t>()};  // a negative int8_t is a mode that does not exist
  setpoint.target.value = reader.number<double>();
  setpoint.target.velocity_ff_rpm = reader.number<float>();
  setpoint.target.torque_ff_nm = reader.number<float>();
  setpoint.target.stiffness_nm_per_rad = reader.number<float>();
  setpoint.target.damping_nms_per_rad = reader.number<float>();
}

// As much of a request as an e-stop needs. False: it is none.
bool decodeEstop(std::span<const std::byte> bytes, link::Request& request) noexcept {
  WireReader reader(bytes);
  if (reader.number<std::int64_t>() != request_t::getHash()) return false;
  (void)reader.number<std::int64_t>();  // utime
  const auto client = reader.anyText();
  const auto session = reader.number<std::uint64_t>();
  const auto seq = reader.number<std::int64_t>();
  const auto operation = reader.anyText();
  if (operationNamed(operation) != Operation::kEstop) return false;
  request.client = client;  // cut off, where it is too long
  request.session = session;
  request.seq = seq;
  request.operation = operation;
  request.target = "";
  request.value_count = 0;
  return true;
}

}  // namespace

Defect decode(std::span<const std::byte> bytes, link::Command& command) noexcept {
  WireReader reader = open(bytes, command_t::getHash());
  (void)reader.number<std::int64_t>();  // utime
  readText(reader, command.client);
  command.session = reader.number<std::uint64_t>();
  command.seq = reader.number<std::int64_t>();
  command.priority = reader.number<std::int32_t>();
  command.validity_ms = reader.number<std::int32_t>();
  command.setpoint_count = reader.count(link::kMaxMotors);
  for (auto& setpoint : std::span{command.setpoints}.first(command.setpoint_count))
    readSetpoint(reader, setpoint);
  reader.end();
  return reader.defect();
}

Defect decode(std::span<const std::byte> bytes, link::Signals& signals) noexcept {
  WireReader reader = open(bytes, signals_t::getHash());
  (void)reader.number<std::int64_t>();  // utime
  (void)reader.number<std::int64_t>();  // mono_us
  readText(reader, signals.client);
  signals.session = reader.number<std::uint64_t>();
  signals.seq = reader.number<std::int64_t>();
  signals.priority = reader.number<std::int32_t>();
  signals.validity_ms = reader.number<std::int32_t>();
  signals.value_count = reader.count(link::kMaxSignals);
  const auto values = std::span{signals.values}.first(signals.value_count);
  for (auto& value : values) readText(reader, value.name);
  for (auto& value : values) value.value = reader.number<double>();
  reader.end();
  return reader.defect();
}

RequestDecoding decode(std::span<const std::byte> bytes, link::Request& request) noexcept {
  WireReader reader = open(bytes, request_t::getHash());
  (void)reader.number<std::int64_t>();  // utime
  readText(reader, request.client);
  request.session = reader.number<std::uint64_t>();
  request.seq = reader.number<std::int64_t>();
  const bool identified = reader.defect() == Defect::kNone;
  readText(reader, request.operation);
  readText(reader, request.target);
  request.value_count = reader.count(link::kMaxValues);
  for (auto& value : std::span{request.values}.first(request.value_count)) {
    readText(reader, value.name);
    value.value = reader.number<double>();
  }
  reader.end();
  const Defect defect = reader.defect();
  if (defect != Defect::kNone && decodeEstop(bytes, request)) return {Defect::kNone, true, defect};
  return {defect, identified};
}

}  // namespace rc10::gateway
