#include "client/state_text.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"
#include "app/printable.hpp"
#include "app/style.hpp"
#include "app/text_table.hpp"
#include "client/quantity_text.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

using Align = TextTable::Align;

std::string note(const link::MotorState& motor) {
  std::string text = link::faultText(motor.fault);
  const std::string limits = link::limitWords(motor.limits);
  if (!limits.empty()) text += (text.empty() ? "limit: " : "; limit: ") + limits;
  const std::string stop = motor.stop_cause == StopCause::kFault
                               ? std::string{}
                               : printable(link::stopText(motor.stop_cause, motor.stopped_by.view()));
  if (!stop.empty()) text += (text.empty() ? "" : "; ") + stop;
  return text;
}

// A motor that is held, damped or braked obeys no target.
std::string modeOf(const link::MotorState& motor) {
  const bool own = motor.acting == Acting::kNothing || motor.acting == Acting::kTarget;
  return own ? toString(motor.mode) : toString(motor.acting);
}

std::string target(const link::MotorState& motor) {
  if (motor.mode == ControlMode::kCoast || motor.mode == ControlMode::kBrake) return "-";
  return quantity(motor.target, motor.mode == ControlMode::kCurrent ? 2 : 1, unitOf(motor.mode));
}

std::string headline(const link::Welcome& welcome, const link::State& state,
                     const link::Diagnostics* diagnostics) {
  std::string text = printable(welcome.robot.view());
  text += std::string("  ") + toString(state.robot_state);
  const std::string stop = printable(link::stopText(state.stop_cause, state.stopped_by.view()));
  text += stop.empty() ? "" : " (" + stop + ")";
  text += state.realtime != 0 ? "" : "  NOT REAL-TIME";
  text += (state.conditions & kConditionSimulated) != 0 ? "  SIMULATED" : "";
  text += (state.conditions & kConditionInputOpen) != 0 ? "  E-STOP INPUT OPEN" : "";
  text += (state.conditions & kConditionReduced) != 0 ? "  REDUCED SPEED" : "";
  text += (state.conditions & kConditionTuningLocked) != 0 ? "  TUNING LOCKED" : "";
  text += "  tick " + std::to_string(state.tick);
  if (diagnostics != nullptr) {
    text += "  wake-up p99 " + quantity(static_cast<double>(diagnostics->wake_latency.p99_us), 0, "us");
    text += ", max " + quantity(static_cast<double>(diagnostics->wake_latency.max_us), 0, "us");
    text += "  missed ticks " + std::to_string(diagnostics->missed_ticks);
  }
  return text + '\n';
}

std::string busLine(const link::BusStatus& bus) {
  std::string text = "bus " + printable(bus.name.view());
  if (!bus.interface.view().empty()) text += " (" + printable(bus.interface.view()) + ")";
  text += std::string("  ") + toString(bus.state);
  text += "  load " + percent(static_cast<double>(bus.measured_load));
  text += " of predicted " + percent(static_cast<double>(bus.predicted_load));
  const auto dropped = bus.rx_dropped + bus.tx_dropped;
  if (dropped != 0) text += "  dropped " + std::to_string(dropped);
  if (bus.error_frames != 0) text += "  error frames " + std::to_string(bus.error_frames);
  return text + '\n';
}

std::string_view styleOf(const link::MotorState& motor) {
  if (motor.status == MotorStatus::kFault) return style::kBad;
  if (motor.status == MotorStatus::kOffline || motor.limits != 0) return style::kDoubtful;
  return motor.status == MotorStatus::kActive ? style::kGood : std::string_view{};
}

std::string_view styleOf(const link::State& state) {
  if (state.robot_state != RobotStatus::kRun) return style::kBad;
  return state.realtime == 0 ? style::kDoubtful : std::string_view{};
}

// The first state is that of a healthy bus.
std::string_view styleOf(const link::BusStatus& bus) {
  if (bus.state != BusState::kActive) return bus.state == BusState::kWarning ? style::kDoubtful : style::kBad;
  return bus.rx_dropped + bus.tx_dropped != 0 ? style::kDoubtful : std::string_view{};
}

// The angle in the turn of its target: -15.3, not 344.7 beside a target of -15.
double angleBeside(const link::MotorState& motor, ControlMode mode) {
  const double target_deg = motor.mode == mode && std::isfinite(motor.target) ? motor.target : 0.0;
  return target_deg + shortestAngle(target_deg, static_cast<double>(motor.angle_deg));
}

}  // namespace

double measured(const link::MotorState& motor, ControlMode mode) noexcept {
  switch (mode) {
    case ControlMode::kCurrent: return static_cast<double>(motor.current_a);
    case ControlMode::kAngle:
    case ControlMode::kImpedance: return angleBeside(motor, mode);
    case ControlMode::kTotalAngle: return motor.total_angle_deg;
    default: return static_cast<double>(motor.velocity_rpm);
  }
}

const char* measuredUnit(ControlMode mode) noexcept {
  const char* unit = unitOf(mode);
  const bool own = mode == ControlMode::kCurrent || mode == ControlMode::kAngle ||
                   mode == ControlMode::kImpedance || mode == ControlMode::kTotalAngle;
  return own ? unit : "rpm";
}

std::string listText(const link::Welcome& welcome) {
  std::string text = "robot " + printable(welcome.robot.view()) + "  rc10d " +
                     printable(welcome.version.view()) + ", pid " + std::to_string(welcome.pid) + ", " +
                     std::to_string(welcome.rate_hz) + " Hz\n";
  if (!welcome.lcm_url.view().empty()) {
    text +=
        "LCM " + printable(welcome.lcm_url.view()) + ", state " + std::to_string(welcome.state_hz) + " Hz\n";
  }
  TextTable table({{"MOTOR"}, {"MODEL"}, {"BUS"}, {"ID", Align::kRight}, {"MODES"}});
  for (std::size_t i = 0; i < std::min<std::size_t>(welcome.motor_count, link::kMaxMotors); ++i) {
    const auto& motor = welcome.motors[i];
    table.add({printable(motor.name.view()), printable(motor.model.view()), printable(motor.bus.view()),
               std::to_string(motor.id), link::modeWords(motor.modes)});
  }
  return text + table.text();
}

std::string stateText(const link::Welcome& welcome, const link::State& state,
                      const link::Diagnostics* diagnostics, bool colour) {
  const auto style = [colour](const auto& what) { return colour ? styleOf(what) : std::string_view{}; };
  std::string text = style::styled(headline(welcome, state, diagnostics), style(state));
  if (diagnostics != nullptr) {
    for (std::size_t i = 0; i < std::min<std::size_t>(diagnostics->bus_count, link::kMaxBuses); ++i) {
      text += style::styled(busLine(diagnostics->buses[i]), style(diagnostics->buses[i]));
    }
  }
  TextTable table({{"MOTOR"},
                   {"STATUS"},
                   {"MODE"},
                   {"TARGET", Align::kRight},
                   {"MEASURED", Align::kRight},
                   {"ANGLE", Align::kRight},
                   {"CURRENT", Align::kRight},
                   {"TEMP", Align::kRight},
                   {"AGE", Align::kRight},
                   {"ZEROED"},
                   {"OWNER"},
                   {"NOTE"}});
  for (std::size_t i = 0; i < std::min<std::size_t>(state.motor_count, welcome.motor_count); ++i) {
    const auto& motor = state.motors[i];
    table.add({printable(welcome.motors[i].name.view()), toString(motor.status), modeOf(motor), target(motor),
               quantity(measured(motor, motor.mode), motor.mode == ControlMode::kCurrent ? 2 : 1,
                        measuredUnit(motor.mode)),
               quantity(shortestAngle(0.0, static_cast<double>(motor.angle_deg)), 1, "deg"),
               quantity(static_cast<double>(motor.current_a), 2, "A"),
               quantity(static_cast<double>(motor.temperature_c), 0, "C"), age(motor.feedback_age_us),
               motor.zeroed != 0 ? "yes" : "no", printable(motor.owner.view()), note(motor)},
              style(motor));
  }
  return text + table.text();
}

const char* whatActs(Acting acting) noexcept {
  switch (acting) {
    case Acting::kHold: return "holds its place (on_timeout)";
    case Acting::kDamp: return "is damped (on_timeout)";
    case Acting::kBrake: return "brakes (on_timeout)";
    case Acting::kRamp: return "comes to rest along a ramp (on_timeout)";
    case Acting::kTarget: return "obeys another target";
    case Acting::kNothing: break;
  }
  return "coasts";
}

}  // namespace rc10::client
