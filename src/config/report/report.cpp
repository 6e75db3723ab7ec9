#include "config/report/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <variant>
#include <vector>

#include "app/mode_words.hpp"
#include "app/text_table.hpp"
#include "bus/frame_text.hpp"
#include "config/check/bus_load_check.hpp"
#include "config/yaml/number_text.hpp"
#include "config/yaml/problem.hpp"
#include "module/serial_keys.hpp"

namespace rc10 {
namespace {

/// With so many significant digits: a person reads it.
std::string rounded(double value, int digits = 6) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return numberText(std::strtod(text.data(), nullptr));
}

std::string rounded(float value) { return rounded(static_cast<double>(value)); }

std::string threadText(const ThreadConfig& thread) {
  return "SCHED_FIFO " + std::to_string(thread.priority) +
         (thread.cpu ? ", CPU " + std::to_string(*thread.cpu) : ", any CPU");
}

bool hasSerialPorts(const RobotConfig& config) {
  return std::any_of(config.modules.begin(), config.modules.end(),
                     [](const ModuleConfig& module) { return module.settings.own.given(kPortKey.name); });
}

std::string receiveText(const RobotConfig& config) {
  if (config.receive != ReceivePolicy::kTick) return "rx thread, " + threadText(config.rx);
  return hasSerialPorts(config) ? "by the tick; serial ports " + threadText(config.rx) : "by the tick";
}

std::string contactText(const ContactGpioConfig& contact) {
  return contact.pin.name() + ", closed contact reads " + (contact.closed_is_low ? "low" : "high") + ", " +
         (contact.internal_bias ? "internal " : "external ") +
         (contact.closed_is_low ? "pull-up" : "pull-down");
}

// Digits of a hash by which a person tells it from others.
constexpr std::size_t kHashDigits = 8;

/// "teleop (LCM): command, clear; anna (user): command; all others observe and stop"
std::string clientsText(const RobotConfig& config) {
  std::string text;
  if (!config.clients) return text;
  for (const auto& client : config.clients->entries) {
    std::vector<std::string> rights;
    for (std::size_t i = 0; i < kRightWords.size(); ++i)
      if (client.rights[i]) rights.emplace_back(kRightWords[i]);
    constexpr std::array kWays{"LCM", "user", "group", "token"};
    const char* by = kWays[static_cast<std::size_t>(client.by)];
    const bool token = client.by == ClientConfig::By::kToken;
    text += (token ? client.who.substr(0, kHashDigits) + "…" : client.who) + " (" + by +
            "): " + (rights.empty() ? "observe" : listWords(rights, ", ")) +
            (client.all_motors ? "; " : ", in part; ");
  }
  return text + "all others observe and stop";
}

std::string robotText(const RobotConfig& config) {
  const bool required = config.realtime == RealtimePolicy::kRequired;
  TextTable table({{""}, {""}});
  table.add({"robot", config.robot + " (" + excerpt(config.file) + ")"});
  table.add({"realtime", required ? "required" : "preferred"});
  table.add({"guard", config.guard == GuardPolicy::kOff        ? "off: nobody rests the drives if rc10d dies"
                      : config.guard == GuardPolicy::kRequired ? "required"
                                                               : "preferred"});
  table.add({"scheduler", std::to_string(config.rate_hz) + " Hz, " + threadText(config.scheduler)});
  table.add({"receive", receiveText(config)});
  table.add({"lcm", config.lcm.enabled
                        ? config.lcm.url + ", state at " + std::to_string(config.lcm.state_hz) + " Hz"
                        : std::string{"off"}});
  if (config.clients) table.add({"clients", clientsText(config)});
  if (config.tuning_locked_at != 0) table.add({"tuning", "locked"});
  if (config.clear_local_at != 0) table.add({"clear", "from this computer only"});
  if (config.estop_gpio) table.add({"e-stop input", contactText(*config.estop_gpio)});
  if (config.enabling_gpio) table.add({"enabling switch", contactText(*config.enabling_gpio)});
  if (config.mode_gpio) table.add({"mode input", contactText(*config.mode_gpio)});
  if (const auto& heartbeat = config.heartbeat_gpio) {
    const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(heartbeat->period).count();
    const auto rests = heartbeat->rests_in_estop_after;
    table.add({"heartbeat", heartbeat->pin.name() + ", every " + std::to_string(period) + " ms" +
                                (rests ? ", until " + std::to_string(*rests / std::chrono::milliseconds{1}) +
                                             " ms after an e-stop"
                                       : std::string{", also in an e-stop"})});
  }
  return table.text();
}

/// `share`: of the limit.
std::string limitText(const MotorConfig& motor, double share = 1.0) {
  const MotorTraits traits = motor.traits();
  const float limit = effortLimitOf(motor.settings, traits.effort_full_scale);
  return rounded(share * static_cast<double>(limit), 4) + (traits.effort == CommandUnit::kVolt ? " V" : " A");
}

double gearRatio(const MotorConfig& motor) { return gearRatioOf(motor.settings, motor.traits()); }

/// "0x201", "0x00000901 (extended) and 3 more".
std::string idsText(const std::vector<BusUse::Stream>& streams) {
  std::vector<CanId> ids;
  for (const auto& stream : streams) {
    if (std::find(ids.begin(), ids.end(), stream.id) == ids.end()) ids.push_back(stream.id);
  }
  if (ids.empty()) return "none";
  return idText(ids.front()) + (ids.size() > 1 ? " and " + std::to_string(ids.size() - 1) + " more" : "");
}

}  // namespace

std::string motorZeroText(const MotorConfig& motor) {
  const MotorTraits traits = motor.traits();
  if (motor.settings.zero_at_power_on) return "at power-on";
  if (traits.absolute && gearRatio(motor) == traits.gear_ratio)
    return "at " + rounded(motor.settings.zero_deg) + " deg";
  return "on request";
}

std::string motorCommandText(const MotorConfig& motor) {
  const auto& settings = motor.settings;
  const BusUse use = motor.family->busUse(settings);
  if (use.slot != 0) return idsText(use.commands) + " slot " + std::to_string(use.slot);
  const std::string rate = rounded(static_cast<double>(settings.tick_hz) / settings.command_divider, 4);
  return idsText(use.commands) + " at " + rate + " Hz";
}

std::string motorFeedbackText(const MotorConfig& motor) {
  const BusUse use = motor.family->busUse(motor.settings);
  const std::string rate = std::to_string(motor.settings.feedback_hz) + " Hz";
  return idsText(use.feedback) + (motor.traits().asked ? ", its answers" : " at " + rate);
}

namespace {

std::string wiringText(const BusConfig& bus, int rate_hz) {
  TextTable table({{"motor"},
                   {"model"},
                   {"id"},
                   {"feedback"},
                   {"command"},
                   {"load"},
                   {"direction"},
                   {"gear"},
                   {"zero"},
                   {"timeout"}});
  const auto loads = predictLoadByMotor(bus, rate_hz);
  for (std::size_t i = 0; i < bus.motors.size(); ++i) {
    const auto& motor = bus.motors[i];
    const auto timeout =
        std::chrono::duration_cast<std::chrono::milliseconds>(motor.feedback_timeout).count();
    table.add({motor.name() + (motor.optional ? " (optional)" : ""), motor.settings.model,
               std::to_string(motor.settings.id), motorFeedbackText(motor), motorCommandText(motor),
               percentText(loads[i].worst_case), motor.settings.direction < 0 ? "reversed" : "normal",
               rounded(gearRatio(motor), 6), motorZeroText(motor), std::to_string(timeout) + " ms"});
  }
  return table.text(2);
}

template <typename Pid>
std::string gains(const Pid& pid) {
  return "kp " + rounded(pid.kp) + ", ki " + rounded(pid.ki) + ", kd " + rounded(pid.kd);
}

std::string velocityLoopText(const CascadeConfig& loops) {
  const bool incremental = std::holds_alternative<PID_Incremental::Config>(loops.velocity);
  return (incremental ? "incremental, " : "position, ") +
         std::visit([](const auto& pid) { return gains(pid); }, loops.velocity);
}

std::string angleLoopText(const CascadeConfig& loops) {
  const float limit_rpm = loops.angle.output_limit;
  return gains(loops.angle) + (limit_rpm > 0.0F ? ", up to " + rounded(limit_rpm) + " rpm" : "");
}

std::string loopsText(const BusConfig& bus) {
  TextTable table({{"motor"}, {"limit"}, {"velocity"}, {"velocity loop"}, {"angle loop"}});
  for (const auto& motor : bus.motors) {
    const CascadeConfig& loops = motor.settings.loops;
    const float limit_rpm = motor.settings.velocity_limit_rpm;
    const MotorTraits traits = motor.traits();
    table.add({motor.name(), limitText(motor), limit_rpm > 0.0F ? rounded(limit_rpm) + " rpm" : "its own",
               traits.hostVelocityLoop() ? velocityLoopText(loops) : "its own",
               traits.host_loops != nullptr ? angleLoopText(loops) : "its own"});
  }
  return table.text(2);
}

std::string fallbackText(FallbackAction action) {
  return std::string{kFallbackWords[static_cast<std::size_t>(action)]};
}

}  // namespace

std::string motorEstopText(const MotorConfig& motor) {
  const auto& fallback = motor.fallback;
  const auto bound = boundOf(fallback.on_estop, true, fallback, motor.traits().frames);
  auto text = fallbackText(fallback.on_estop);
  if (fallback.on_estop == FallbackAction::kRamp)
    return text + ", after " + rounded(std::chrono::duration<double>(fallback.ramp).count()) + " s coast";
  if (!bound.most || bound.then == frameKindOf(fallback.on_estop)) return text;
  const double seconds = std::chrono::duration<double>(*bound.most).count();
  const char* then = bound.then == FrameKind::kDamp ? " s damp" : " s brake";
  return text + ", after " + rounded(seconds) + then;
}

namespace {

std::string softLimitsText(const ShapingConfig& shaping) {
  if (!std::isfinite(shaping.angle_min_deg) && !std::isfinite(shaping.angle_max_deg)) return "none";
  const auto end = [](double deg) { return std::isfinite(deg) ? rounded(deg) : std::string{"any"}; };
  return end(shaping.angle_min_deg) + " to " + end(shaping.angle_max_deg) + " deg";
}

std::string overspeedText(const GuardConfig& guard) {
  return guard.overspeed_rpm > 0.0F ? rounded(static_cast<double>(guard.overspeed_rpm), 4) + " rpm"
                                    : "not watched";
}

/// "60 rpm within 1000 ms, 5 A".
std::string reducedText(const MotorConfig& motor) {
  const ReducedConfig& reduced = motor.reduced;
  std::string text;
  if (reduced.velocity_rpm > 0.0F)
    text = numberText(reduced.velocity_rpm) + " rpm within " +
           std::to_string(reduced.within / std::chrono::milliseconds{1}) + " ms";
  if (reduced.effort_share < 1.0F)
    text += (text.empty() ? "" : ", ") + limitText(motor, static_cast<double>(reduced.effort_share));
  return text.empty() ? "not reduced" : text;
}

/// While a person is near; empty without a mode input.
std::string reducedText(const RobotConfig& config) {
  if (!config.mode_gpio) return {};
  std::string text = "\nwhile the mode input is open:\n";
  TextTable table({{""}, {""}});
  for (const auto& bus : config.buses)
    for (const auto& motor : bus.motors) table.add({motor.name(), reducedText(motor)});
  return text + table.text(2);
}

/// Fallbacks and travel limits of each motor.
std::string safetyText(const BusConfig& bus) {
  TextTable table({{"motor"}, {"time-out"}, {"disable"}, {"e-stop"}, {"over-speed"}, {"soft limits"}});
  for (const auto& motor : bus.motors) {
    table.add({motor.name(), fallbackText(motor.fallback.on_timeout), fallbackText(motor.fallback.on_disable),
               motorEstopText(motor), overspeedText(motor.guard), softLimitsText(motor.shaping)});
  }
  return table.text(2);
}

std::string groupsText(const RobotConfig& config) {
  std::vector<const MotorConfig*> motors;
  for (const auto& bus : config.buses) {
    for (const auto& motor : bus.motors) motors.push_back(&motor);
  }
  std::string text;
  for (const auto& group : config.groups) {
    std::vector<std::string> members;
    std::vector<std::string> optional;
    for (const auto motor : group.motors) {
      members.push_back(motors[motor]->name());
      if (motors[motor]->optional) optional.push_back(motors[motor]->name());
    }
    const bool rearms = group.on_return == GroupConfig::Return::kRearmAtRest;
    text += "\ngroup " + group.name + (group.implied ? " (of its module)" : "") + ": " + listWords(members) +
            (group.together ? " are enabled and stop together" : " stop together") +
            ", and are enabled again " + (rearms ? "by themselves at rest" : "by request");
    if (!optional.empty()) {
      text += "; nothing stops or waits for " + listWords(optional) +
              (optional.size() == 1 ? ", which is optional" : ", which are optional");
    }
    text += "\n";
  }
  return text;
}

std::string modulesText(const RobotConfig& config) {
  std::string text;
  for (const auto& module : config.modules) {
    text += "\nmodule " + module.settings.name + ": " + std::string{module.type->name()} + ", priority " +
            std::to_string(module.settings.priority) + ". " + std::string{module.type->about()} + "\n";
  }
  return text;
}

/// One line for all motors that take the same modes.
std::string modesText(const BusConfig& bus) {
  std::map<std::string, std::vector<std::string>> motors_by_modes;
  for (const auto& motor : bus.motors)
    motors_by_modes[modeWords(motor.traits().modes, ", ")].push_back(motor.name());
  std::string text;
  for (const auto& [modes, motors] : motors_by_modes) {
    text += "  modes of " + (motors_by_modes.size() == 1 ? "all" : listWords(motors)) + ": " + modes + "\n";
  }
  return text;
}

std::string busText(const BusConfig& bus, int rate_hz) {
  const bool simulated = bus.type == BusType::kSimulated;
  std::string text = "\nbus " + bus.name + ": ";
  text += simulated ? "simulated, seed " + std::to_string(bus.sim_seed) : "SocketCAN on " + bus.interface;
  if (bus.manage_link) text += " (set up by rc10d)";
  text += ", " + std::to_string(bus.bitrate) + " bit/s, ";
  if (bus.data_bitrate > 0) text += "CAN FD data at " + std::to_string(bus.data_bitrate) + " bit/s, ";
  text += "predicted load " + loadText(predictLoad(bus, rate_hz)) + " (no stuff bits, all stuff bits)\n";
  return text + wiringText(bus, rate_hz) + "\n" + loopsText(bus) + "\n" + safetyText(bus) + "\n" +
         modesText(bus);
}

/// The families without a watchdog of their own, each once.
std::vector<std::string> unwatchedFamilies(const RobotConfig& config) {
  std::vector<std::string> families;
  for (const auto& bus : config.buses) {
    for (const auto& motor : bus.motors) {
      const std::string name{motor.family->name()};
      if (motor.traits().watchdog || std::find(families.begin(), families.end(), name) != families.end())
        continue;
      families.push_back(name);
    }
  }
  return families;
}

std::string watchdogText(const RobotConfig& config) {
  const auto families = unwatchedFamilies(config);
  if (families.empty()) return "";
  return "\nnote: " + listWords(families) +
         " drives have no command watchdog that rc10d can set or verify:\n"
         "if this computer stops, they may go on with their last command. Wire an emergency stop that cuts "
         "the\n"
         "motors' power" +
         (config.heartbeat_gpio ? ", and the relay of heartbeat_gpio.\n"
                                : "; heartbeat_gpio can drive a relay.\n");
}

/// The motors whose drives cannot be seen to rest.
std::string restText(const RobotConfig& config) {
  std::vector<std::string> motors;
  for (const auto& bus : config.buses) {
    for (const auto& motor : bus.motors)
      if (!(motor.rest.current_a > 0.0F)) motors.push_back(motor.name());
  }
  if (motors.empty()) return "";
  return "\nnote: whether " + listWords(motors) + " rest" + (motors.size() == 1 ? "s" : "") +
         " when told to is not verified: a current with its sign is not reported, or not watched.\n";
}

}  // namespace

std::string describe(const RobotConfig& config) {
  std::string text = robotText(config);
  for (const auto& bus : config.buses) text += busText(bus, config.rate_hz);
  return text + reducedText(config) + groupsText(config) + modulesText(config) + watchdogText(config) +
         restText(config);
}

}  // namespace rc10
