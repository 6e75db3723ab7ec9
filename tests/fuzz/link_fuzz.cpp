// Commands, requests and signals of a stranger on the link, with words that mean something and others: what
// admission and the request desk let through is within the bounds of the robot.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/load_config.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/request_desk.hpp"
#include "daemon/clients/signal_admission.hpp"
#include "fuzz_input.hpp"
#include "link/link_message.hpp"

namespace {

using namespace rc10;
using fuzz::Input;
using fuzz::require;

constexpr std::string_view kRobot =
    "robot: fuzz\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"
    "      - {name: wheel, model: M3508, id: 1, velocity_pid: {type: position, kp_a_per_rpm: 0.2},\n"
    "         angle_pid: {kp_rpm_per_deg: 3}}\n"
    "      - {name: arm, model: DM4310, id: 2, master_id: 17}\n"
    "      - {name: turret, model: GM6020, id: 5, velocity_pid: {type: incremental, kp_a_per_rpm: 0.1}}\n";
constexpr std::size_t kMotorCount = 3;
constexpr MonotonicTime kNow{std::chrono::hours{1}};

constexpr std::array<std::string_view, 29> kWords{
    "wheel",        "arm",        "turret",    "enable",
    "disable",      "estop",      "clear",     "zero",
    "set_gains",    "get_config", "angle_deg", "configure-drive",
    "velocity.kp",  "angle.ki",   "kd",        "velocity_pid.kp_a_per_rpm",
    "velocity.",    ".kp",        "wheel,arm", "wheel,wheel",
    "timeout_ms",   "base",       "speed",     "angle_pid.velocity_limit_rpm",
    "enable_alone", "scan",       "front",     "listen_s",
    "listen_only"};

/// A word that means something, or bytes.
template <typename Text>
Text text(Input& input) {
  const auto choice = input.take<std::uint8_t>();
  if (choice < kWords.size()) return Text{kWords[choice]};
  if (choice < 128) return {};
  return input.take<Text>();
}

RobotDescription described() {
  const auto config = parseRobotConfig(std::string{kRobot}, "fuzz.yaml").config.value();
  RobotDescription robot;
  for (const auto& motor : config.buses[0].motors) {
    auto& known = robot.motors.emplace_back();
    known.name = motor.settings.name;
    known.modes = ModeSet{ControlMode::kVelocity, ControlMode::kAngle};
    known.loops = {motor.settings.model, motor.traits(), motor.settings.loops};
  }
  robot.buses.push_back({"front", "can0"});
  auto& base = robot.modules.emplace_back();
  base.name = "base";
  base.signals.inputs = {"speed"};
  return robot;
}

/// The parts of the link thread, and the inputs of a stranger.
class Desk {
 public:
  void command(Input& input) {
    link::Command message;
    identify(message, input);
    message.priority = input.take<std::int32_t>();
    message.validity_ms = input.take<std::int32_t>();
    message.setpoint_count = input.take<std::uint8_t>() % 5U;
    for (auto& setpoint : std::span{message.setpoints}.first(message.setpoint_count)) {
      setpoint.motor = text<link::Name>(input);
      setpoint.target.mode = ControlMode{input.take<std::uint8_t>()};
      setpoint.target.value = input.take<double>();
      setpoint.target.velocity_ff_rpm = input.take<float>();
    }
    Command out;
    if (admission_.admit(message, {}, kNow, out) != CommandRefusal::kNone) return;
    require(out.count == message.setpoint_count && out.count > 0);
    require(out.deadline > kNow - kMaxValidity && out.deadline <= kNow + kMaxValidity);
    MotorSet seen;
    for (const auto& setpoint : std::span{out.setpoints}.first(out.count)) {
      require(setpoint.motor < kMotorCount && !seen.test(setpoint.motor));
      seen.set(setpoint.motor);
      require(std::isfinite(setpoint.target.value) && std::isfinite(setpoint.target.velocity_ff_rpm));
    }
  }

  void request(Input& input) {
    link::Request message;
    identify(message, input);
    message.operation = text<link::Text<32>>(input);
    message.target = text<link::Text<64>>(input).view();
    message.value_count = input.take<std::uint8_t>() % 4U;
    for (auto& value : std::span{message.values}.first(message.value_count)) {
      value.name = text<link::Text<48>>(input);
      value.value = input.take<double>();
    }
    const auto outcome = desk_.begin(message, {.connection = 1}, kNow);
    require(!outcome.order || !outcome.response);
    if (outcome.response) told(*outcome.response);
    if (!outcome.order) return;
    const auto& order = *outcome.order;
    require(order.motors.any() && (order.motors >> kMotorCount).none());
    require(order.operation != Operation::kEnableAlone || order.motors.count() == 1);
    require(std::isfinite(order.value));
    for (const auto& change : std::span{order.gains.values}.first(order.gains.count)) {
      require(std::isfinite(change.value) && change.value >= 0.0F);
      require(static_cast<std::size_t>(change.gain) < kLoopGainCount);
    }
    open_.push_back(order.id);
  }

  void finish(Input& input) {
    if (open_.empty()) return;
    OrderResult result{.id = open_.front()};
    open_.erase(open_.begin());
    result.refused = input.take<std::uint8_t>() % 4U == 0;
    for (auto& refusal : std::span{result.motors}.first(kMotorCount))
      refusal = input.take<std::uint8_t>() % 2U == 0 ? Refusal::kNone : Refusal::kStopping;
    const auto answer = desk_.finish(result);
    require(answer.has_value());
    told(answer->response);
  }

  void signals(Input& input) {
    link::Signals message;
    identify(message, input);
    message.validity_ms = input.take<std::int32_t>();
    message.module = text<link::Name>(input);
    message.value_count = input.take<std::uint8_t>() % 4U;
    for (auto& value : std::span{message.values}.first(message.value_count)) {
      value.name = text<link::Text<48>>(input);
      value.value = input.take<double>();
    }
    SignalMessage out;
    if (signals_.admit(message, {}, kNow, out) != CommandRefusal::kNone) return;
    require(out.module == 0);
    for (std::size_t i = 0; i < out.values.size(); ++i)
      require(i < 1 ? !std::isinf(out.values[i]) : std::isnan(out.values[i]));
  }

 private:
  template <typename Message>
  static void identify(Message& message, Input& input) {
    message.client = text<link::Name>(input);
    message.session = input.take<std::uint8_t>();
    message.seq = input.take<std::int16_t>();
    message.received_ns = kNow.time_since_epoch().count() - input.take<std::int32_t>();
  }
  static void told(const link::Response& response) {
    require(link::countsFit(response));
    require(!response.message.view().empty() || response.status == link::ResponseStatus::kOk);
    for (const auto& value : std::span{response.values}.first(response.value_count))
      require(std::isfinite(value.value));
  }

  RobotDescription robot_ = described();
  Admission admission_{robot_};
  SignalAdmission signals_{robot_};
  RequestDesk desk_{admission_, robot_};
  std::vector<std::uint64_t> open_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Desk desk;
  while (!input.empty()) {
    switch (input.take<std::uint8_t>() % 4U) {
      case 0: desk.command(input); break;
      case 1: desk.request(input); break;
      case 2: desk.finish(input); break;
      default: desk.signals(input); break;
    }
  }
  return 0;
}
