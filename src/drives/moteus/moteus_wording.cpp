#include "drives/moteus/moteus_wording.hpp"

#include <cstdint>
#include <string>

#include "drives/moteus/moteus_frames.hpp"

namespace rc10 {
namespace {

// A frame of 64 bytes has hardly more.
constexpr int kMostItems = 32;

std::string moteusRegister(moteus::Register reg) {
  using moteus::Register;
  switch (reg) {
    case Register::kMode: return "mode";
    case Register::kPosition: return "position (rev)";
    case Register::kVelocity: return "velocity (rev/s)";
    case Register::kTorque: return "torque (Nm)";
    case Register::kQCurrent: return "q current (A)";
    case Register::kDCurrent: return "d current (A)";
    case Register::kVoltage: return "voltage (V)";
    case Register::kTemperature: return "temperature (°C)";
    case Register::kMotorTemperature: return "motor temperature (°C)";
    case Register::kFault: return "fault";
    case Register::kCommandPosition: return "command position (rev)";
    case Register::kCommandVelocity: return "command velocity (rev/s)";
    case Register::kCommandTorque: return "command torque (Nm)";
    case Register::kCommandQCurrent: return "command q current (A)";
    case Register::kKpScale: return "kp scale";
    case Register::kKdScale: return "kd scale";
    case Register::kMaxTorque: return "maximum torque (Nm)";
    case Register::kTimeout: return "timeout (s)";
    default: break;
  }
  return "register " + std::to_string(static_cast<std::uint32_t>(reg));
}

}  // namespace

std::string wordMoteus(const CanFrame& frame, std::string_view /*model*/, bool sent) {
  if (!frame.fd) return {};
  // To a drive its id is the lowest byte, from it the one above.
  const int id = static_cast<int>(sent ? frame.id.value & 0x7FU : frame.id.value >> 8U & 0x7FU);
  FrameWords words{id, sent ? "told" : "answers"};
  moteus::Reader reader(frame.payload());
  for (int items = 0; items < kMostItems; ++items) {
    moteus::Item item;
    const auto step = reader.next(item);
    if (step == moteus::Reader::Step::kMalformed) return {};
    if (step == moteus::Reader::Step::kEnd) break;
    const auto name = moteusRegister(item.reg);
    switch (item.kind) {
      case moteus::Item::Kind::kWrite:
      case moteus::Item::Kind::kReply: words.add(name, item.value); break;
      case moteus::Item::Kind::kRead: words.word(name + "?"); break;
      case moteus::Item::Kind::kError: words.add("error of " + name, item.value); break;
    }
  }
  return words.take();
}

}  // namespace rc10
