// Arbitrary frames, orders and targets to Damiao motors and their simulated drives: readings stay finite,
// angles in [0, 360), and what leaves is valid and within the limits; flash is never written.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "bus/byte_order.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "drives/damiao/damiao_motor.hpp"
#include "drives/damiao/damiao_simulated.hpp"
#include "motor_orders.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr float kLimitA = 2.5F;
constexpr double kLimitRadS = 100.0 * 0.10471976;

MotorSettings settingsOf(int id) {
  const auto control = kDamiaoControlNames[static_cast<std::size_t>(id - 1) % 4];
  MotorSettings settings;
  settings.name = "motor" + std::to_string(id);
  settings.model = id % 2 == 0 ? "DM4310" : "DMH3510";
  settings.id = id;
  settings.direction = id % 2 == 0 ? -1 : 1;
  settings.velocity_limit_rpm = 100.0F;
  settings.command_divider = id;
  if (control == "mit" || control == "force_position") settings.effort_limit = kLimitA;
  settings.own.set("master_id", 0.0);
  settings.own.set("control", std::string{control});
  settings.own.set("watchdog_ms", 100.0);
  settings.own.set("can_fd", id == 2 ? 1.0 : 0.0);
  require(damiaoFamily().check(settings).has_value());
  return settings;
}

struct Pair {
  explicit Pair(int id)
      : settings(settingsOf(id)),
        own(damiaoSettings(settings)),
        motor(settings),
        drive(sim::makeDamiaoDrive(settings, {})) {}
  MotorSettings settings;
  DamiaoSettings own;
  Damiao_Motor motor;
  std::unique_ptr<sim::Drive> drive;
};

CanFrame takeFrame(Input& input) {
  CanFrame frame;
  const auto head = input.take<std::uint32_t>();
  frame.id = {(head & 0x800U) != 0 ? head & 0x7FFU : 0U, (head & 0x1000U) != 0};
  frame.fd = (head & 0x2000U) != 0;
  frame.type = (head & 0x4000U) != 0 ? FrameType::kRemote : FrameType::kData;
  const auto odd = static_cast<std::uint8_t>((head >> 16U) & 0x3FU);
  frame.length = odd < 48 ? std::uint8_t{8} : odd;
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = input.take<std::uint8_t>();
  return frame;
}

bool isSpecial(const CanFrame& frame) {
  for (std::size_t i = 0; i < 7; ++i) {
    if (frame.data[i] != 0xFF) return false;
  }
  return frame.length == 8 && (frame.data[7] == 0xFB || frame.data[7] == 0xFC || frame.data[7] == 0xFD);
}

void checkSent(const Pair& pair, const CanFrame& frame) {
  const auto payload = std::span(frame.data).first<8>();
  require(frame.type == FrameType::kData && !frame.id.extended && frame.fd == pair.own.can_fd);
  if (frame.id.value == damiao::kRegisterId) {
    require(frame.length == 8 && payload[0] == pair.settings.id && payload[1] == 0);
    require(payload[2] == 0x33 || (payload[2] == 0x55 && (payload[3] == 9 || payload[3] == 10)));
    return;
  }
  require(frame.id == pair.motor.commandIds()[0]);
  if (isSpecial(frame)) return;
  switch (pair.own.control) {
    case DamiaoControl::kMit: {
      require(frame.length == 8);
      const auto command = damiao::readMit(payload, pair.own.scale);
      const double limit_nm =
          static_cast<double>(kLimitA * findDamiaoModel(pair.settings.model)->torque_nm_per_a);
      require(std::fabs(command.torque_nm) <= limit_nm + 2.0 * pair.own.scale.t_max_nm / 4095.0);
      break;
    }
    case DamiaoControl::kVelocity:
      require(frame.length == 4);
      require(std::fabs(static_cast<double>(readLittleEndian<float>(payload, 0))) <= kLimitRadS + 1e-3);
      break;
    case DamiaoControl::kPositionVelocity: {
      const auto limit_rad_s = static_cast<double>(readLittleEndian<float>(payload, 4));
      require(frame.length == 8 && std::isfinite(readLittleEndian<float>(payload, 0)));
      require(limit_rad_s >= 0.0 && limit_rad_s <= kLimitRadS + 1e-3);
      break;
    }
    case DamiaoControl::kForcePosition:
      require(frame.length == 8 && std::isfinite(readLittleEndian<float>(payload, 0)));
      require(readLittleEndian<std::uint16_t>(payload, 4) <= 1048);
      require(readLittleEndian<std::uint16_t>(payload, 6) <= 2500);
      break;
  }
}

void checkMotor(const Damiao_Motor& motor) {
  const MotorFeedback& feedback = motor.feedback();
  require(std::isfinite(motor.commandValue()));
  if (motor.commandUnit() == CommandUnit::kAmpere)
    require(std::fabs(motor.commandValue()) <= kLimitA * 1.001F);
  if (feedback.samples == 0) return;
  require(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  require(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.velocity_rpm));
  require(std::isfinite(feedback.current_a) && std::isfinite(feedback.torque_nm));
  require(std::isfinite(feedback.temperature_c));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Pair mit(1);
  Pair position(2);
  Pair velocity(3);
  Pair force(4);
  const std::array<Pair*, 4> pairs{&mit, &position, &velocity, &force};
  // Two start enabled, if they can be.
  for (Pair* pair : {&mit, &force}) pair->motor.order(FrameKind::kEnable);

  Input input(data, size);
  MonotonicTime now{std::chrono::hours{1}};
  Tick tick;
  for (int warm_up = 0; warm_up < 40 || !input.empty(); ++warm_up) {
    if (warm_up >= 40) {
      const auto action = input.take<std::uint8_t>();
      Pair& pair = *pairs[action % pairs.size()];
      switch ((action >> 2U) % 9U) {
        case 0: pair.motor.order(static_cast<FrameKind>(input.take<std::uint8_t>() % 9U)); break;
        case 1: (void)pair.motor.setTarget(fuzz::takeTarget(input)); break;
        case 2: pair.motor.order(FrameKind::kCommand, fuzz::takeTarget(input)); break;
        case 3: (void)pair.motor.setZero(input.take<double>()); break;
        case 4: pair.motor.derate(input.take<float>()); break;
        case 5: pair.motor.clearComplaint(); break;
        case 6: pair.drive->fault(input.take<std::uint8_t>()); break;
        case 7: pair.drive->restart(); break;
        default: {
          CanFrame frame = takeFrame(input);
          frame.received = now + Duration{input.take<std::int32_t>()};
          for (Pair* each : pairs) {
            each->drive->receive(frame);
            if (each->motor.matchesFrame(frame)) (void)each->motor.updateFeedback(frame);
          }
        }
      }
    }
    ++tick.index;
    tick.now = now += std::chrono::milliseconds{1};
    for (Pair* each : pairs) {
      each->motor.update(tick);
      checkMotor(each->motor);
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      const auto count = each->motor.packCommand(tick, out);
      require(count <= out.size());
      for (std::size_t i = 0; i < count; ++i) {
        checkSent(*each, out[i]);
        each->drive->receive(out[i]);
      }
      each->drive->step(std::chrono::milliseconds{1});
      std::array<CanFrame, sim::Drive::kMaxFrames> in{};
      const auto answers = each->drive->answers(in);
      for (std::size_t i = 0; i < answers; ++i) {
        in[i].received = now;
        if (each->motor.matchesFrame(in[i])) (void)each->motor.updateFeedback(in[i]);
      }
      checkMotor(each->motor);
    }
  }
  return 0;
}
