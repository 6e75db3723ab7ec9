#include "survey/recogniser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bus/byte_order.hpp"
#include "drives/cubemars/cubemars_frames.hpp"
#include "drives/damiao/damiao_frames.hpp"
#include "drives/dji/dji_model.hpp"
#include "drives/lktech/lktech_frames.hpp"
#include "drives/moteus/moteus_frames.hpp"
#include "drives/myactuator/myactuator_frames.hpp"
#include "drives/odrive/odrive_frames.hpp"
#include "drives/robstride/robstride_frames.hpp"
#include "drives/vesc/vesc_frames.hpp"

namespace rc10::survey {
namespace {

using Guesses = std::vector<Guess>;

// C620 and C610 cannot be told apart by their frames: where one has the temperature the other has nothing.
constexpr std::string_view kC6xx = "DJI M3508 or M2006";
constexpr std::string_view kGm6020 = "DJI GM6020";
constexpr std::string_view kDamiao = "Damiao";
constexpr std::string_view kRobStride = "RobStride or CyberGear";
constexpr std::string_view kCubeMarsServo = "CubeMars (servo)";
constexpr std::string_view kCubeMarsMit = "CubeMars (MIT)";
constexpr std::string_view kMoteus = "moteus";
constexpr std::string_view kLKTech = "LK-Tech";
constexpr std::string_view kMyActuator = "MyActuator";

// Of their encoders: the angle is 0 to 8191.
constexpr unsigned kDjiCounts = 8192;
// Above this a master id of a Damiao would be taken for a command to another drive of one of its modes.
constexpr std::uint32_t kDamiaoMasterMax = 0xFF;
// What a Damiao may tell in its status: disabled, enabled, and from "sensor" to "overload".
constexpr std::array<std::uint8_t, 10> kDamiaoStatuses{0x0, 0x1, 0x5, 0x8, 0x9, 0xA, 0xB, 0xC, 0xD, 0xE};
constexpr std::uint8_t kOdriveLastState = 14;

template <typename T, std::size_t N>
bool isOneOf(T value, const std::array<T, N>& all) {
  return std::find(all.begin(), all.end(), value) != all.end();
}

bool isStandard8(const CanFrame& frame) { return !frame.id.extended && frame.length == 8; }

// Feedback at 0x200 + id, of GM6020 at 0x204 + id; commands at the ids of the tables.
void addDji(const CanFrame& frame, Guesses& guesses) {
  if (!isStandard8(frame) || frame.fd) return;
  const auto of = [&](const DjiModel& model, std::string_view kind) {
    const int id = static_cast<int>(frame.id.value) - model.feedback_id_base;
    if (id >= 1 && id <= model.max_id && readBigEndian<std::uint16_t>(frame.payload(), 0) < kDjiCounts)
      guesses.push_back({kind, id});
    const auto commands = {model.current.command_ids, model.voltage.command_ids};
    for (const auto& ids : commands) {
      if (frame.id.value != 0 && (frame.id.value == ids[0] || frame.id.value == ids[1])) {
        guesses.push_back({kind, 0, false});
        return;
      }
    }
  };
  of(kM3508, kC6xx);
  of(kGM6020, kGm6020);
}

void addVesc(const CanFrame& frame, Guesses& guesses) {
  if (!frame.id.extended || frame.fd || frame.id.value > 0xFFFF) return;
  const auto packet = static_cast<VescPacket>(frame.id.value >> 8U);
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  switch (packet) {
    case VescPacket::kStatus1:
    case VescPacket::kStatus2:
    case VescPacket::kStatus3:
    case VescPacket::kStatus4:
    case VescPacket::kStatus5:
    case VescPacket::kStatus6:
      if (frame.length == kVescStatusLength) guesses.push_back({kVesc, id});
      return;
    case VescPacket::kPong:  // to who asked; the drive's id is the first byte
      if (frame.length >= 1) guesses.push_back({kVesc, frame.data[0]});
      return;
    case VescPacket::kSetDuty:
    case VescPacket::kSetCurrent:
    case VescPacket::kSetCurrentBrake:
    case VescPacket::kSetErpm:
    case VescPacket::kSetPosition:
      if (frame.length == 4) guesses.push_back({kVesc, id, false});
      return;
    default: return;
  }
}

// The drive's id is in the second byte of the id, that of the host in the first.
void addRobStride(const CanFrame& frame, Guesses& guesses) {
  if (!frame.id.extended || frame.fd || frame.length != 8) return;
  constexpr std::uint32_t kToAnyHost = 0xFE;  // the answer to the question for the id
  const auto type = static_cast<RobStrideType>(frame.id.value >> 24U);
  const int drive = static_cast<int>(frame.id.value >> 8U & 0xFFU);
  const bool answers =
      type == RobStrideType::kFeedback || type == RobStrideType::kReport || type == RobStrideType::kFault ||
      (type == RobStrideType::kGetId && (frame.id.value & 0xFFU) == kToAnyHost && frame.id.value <= 0xFFFF);
  if (answers && drive != 0) guesses.push_back({kRobStride, drive});
  if (type == RobStrideType::kOperate)
    guesses.push_back({kRobStride, static_cast<int>(frame.id.value & 0xFFU), false});
}

void addDamiao(const CanFrame& frame, Guesses& guesses) {
  if (!isStandard8(frame) || frame.id.value > kDamiaoMasterMax) return;
  const int id = frame.data[0] & 0x0F;
  const auto status = static_cast<std::uint8_t>(frame.data[0] >> 4U);
  if (id >= 1 && id <= damiao::kMaxId && isOneOf(status, kDamiaoStatuses)) guesses.push_back({kDamiao, id});
}

void addCubeMars(const CanFrame& frame, Guesses& guesses) {
  if (frame.fd) return;
  const int id = static_cast<int>(frame.id.value & 0xFFU);
  if (frame.id.extended && frame.id == cubemars::servoFeedbackId(id) && cubemars::readServoReport(frame))
    guesses.push_back({kCubeMarsServo, id});
  // To the host 0, or to its own id; 6 bytes from the oldest firmware.
  const int told = frame.data[0];
  const bool to_host = frame.id.value == 0 || static_cast<int>(frame.id.value) == told;
  if (!frame.id.extended && to_host && told != 0 && (frame.length == 8 || frame.length == 6))
    guesses.push_back({kCubeMarsMit, told});
}

bool isMoteusAnswer(const CanFrame& frame) {
  MoteusReader reader(frame.payload());
  bool answered = false;
  for (;;) {
    MoteusItem item;
    const auto step = reader.next(item);
    if (step == MoteusReader::Step::kMalformed) return false;
    if (step == MoteusReader::Step::kEnd) return answered;
    if (item.kind != MoteusItem::Kind::kReply && item.kind != MoteusItem::Kind::kError) return false;
    answered = true;
  }
}

void addMoteus(const CanFrame& frame, Guesses& guesses) {
  if (!frame.fd || !isMoteusAnswer(frame)) return;
  const std::uint32_t prefix = frame.id.value >> 16U;
  const std::uint32_t id = frame.id.value >> 8U & 0x7FU;
  if (frame.id == moteusReplyId(prefix, id)) guesses.push_back({kMoteus, static_cast<int>(id)});
}

void addOdrive(const CanFrame& frame, Guesses& guesses) {
  if (frame.id.extended || frame.fd) return;
  const int node = static_cast<int>(frame.id.value >> kOdriveMessageBits);
  const auto message = odriveMessage(frame.id);
  if (message == OdriveMessage::kHeartbeat) {
    const auto beat = decodeOdriveHeartbeat(frame);
    if (beat && static_cast<std::uint8_t>(beat->state) <= kOdriveLastState)
      guesses.push_back({kODrive, node});
  }
  if (message == OdriveMessage::kEncoderEstimates) {
    const auto pair = decodeOdrivePair(frame);
    // Numbers that a shaft can have: bytes of another protocol read as floats are seldom.
    const auto sane = [](float value) {
      return std::isfinite(value) && (value == 0.0F || (std::abs(value) > 1e-9F && std::abs(value) < 1e7F));
    };
    if (pair && sane(pair->first) && sane(pair->second)) guesses.push_back({kODrive, node});
  }
}

// The id is that of another family too. What says most is the heartbeat: an axis is in a state from "idle"
// on, and bytes 5 and 6 are a code and a flag. A VESC or CubeMars at rest has zeros there.
void addOdriveExtended(const CanFrame& frame, Guesses& guesses) {
  constexpr std::uint8_t kHighestCode = 15;
  if (!frame.id.extended || odriveMessage(frame.id) != OdriveMessage::kHeartbeat) return;
  const auto beat = decodeOdriveHeartbeat(frame);
  if (!beat || beat->byte5 > kHighestCode || beat->byte6 > kHighestCode) return;
  const auto state = static_cast<std::uint8_t>(beat->state);
  if (state >= static_cast<std::uint8_t>(OdriveAxisState::kIdle) && state <= kOdriveLastState)
    guesses.push_back({kODriveExtended, static_cast<int>(frame.id.value >> kOdriveMessageBits)});
}

bool isLkTechAnswer(std::span<const std::uint8_t> payload) {
  using lktech::Code;
  switch (lktech::codeOf(payload)) {
    case Code::kStatus:
    case Code::kClear:
    case Code::kReading:
    case Code::kCurrent:
    case Code::kVelocity:
    case Code::kPosition:
    case Code::kAngle: return true;
    default: return false;
  }
}

// Their commands have the same ids, and those of MyActuator are the same: what is no answer may be either's.
void addLKTech(const CanFrame& frame, Guesses& guesses) {
  if (!isStandard8(frame) || frame.fd) return;
  const int id = static_cast<int>(frame.id.value) - static_cast<int>(lktech::kBaseId);
  if (id < 1 || id > lktech::kMaxId || !isLkTechAnswer(frame.payload())) return;
  const bool command = lktech::looksLikeCommand(frame.payload());
  guesses.push_back({kLKTech, id, !command});
  if (command) guesses.push_back({kMyActuator, id, false});
}

void addMyActuator(const CanFrame& frame, Guesses& guesses) {
  if (!isStandard8(frame) || frame.fd) return;
  using myactuator::Code;
  const auto within = [&](std::uint32_t base) {
    const int id = static_cast<int>(frame.id.value) - static_cast<int>(base);
    return id >= 1 && id <= myactuator::kMaxId ? id : 0;
  };
  if (const int id = within(myactuator::kReplyBase); id != 0) {
    switch (myactuator::codeOf(frame.payload())) {
      case Code::kStatus:
      case Code::kReading:
      case Code::kCurrent:
      case Code::kVelocity:
      case Code::kPosition:
      case Code::kAngle:
      case Code::kUptime:
      case Code::kShutdown:
      case Code::kSilenceStopped: guesses.push_back({kMyActuator, id}); return;
      default: return;
    }
  }
  if (const int id = within(myactuator::kMotionReplyBase); id != 0 && frame.data[0] == id)
    guesses.push_back({kMyActuator, id});
}

}  // namespace

std::vector<Guess> recognise(const CanFrame& frame) {
  Guesses guesses;
  if (frame.type != FrameType::kData) return guesses;
  for (const auto add : {addDji, addVesc, addRobStride, addDamiao, addCubeMars, addMoteus, addOdrive,
                         addOdriveExtended, addLKTech, addMyActuator})
    add(frame, guesses);
  return guesses;
}

}  // namespace rc10::survey
