#include "client/motor_signal.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "app/motor_readings.hpp"
#include "app/nearest.hpp"
#include "app/printable.hpp"
#include "client/find_motor.hpp"

namespace rc10::client {
namespace {

using link::MotorState;

struct Readable {
  std::string_view name;
  double (*read)(const MotorState& motor);
};

constexpr std::array kSignals{
#define RC10_READABLE(type, name, initial) \
  Readable{#name, [](const MotorState& m) { return static_cast<double>(m.name); }},
    RC10_MOTOR_READINGS(RC10_READABLE)
#undef RC10_READABLE
};

// The name as it is, or without what follows its last underscore.
bool means(std::string_view name, std::string_view text) {
  return name == text || name.substr(0, name.rfind('_')) == text;
}

std::vector<std::string_view> signalWords() {
  std::vector<std::string_view> words;
  for (const auto& signal : kSignals) {
    words.push_back(signal.name);
    words.push_back(signal.name.substr(0, signal.name.rfind('_')));
  }
  return words;
}

std::string signalNames() {
  std::string names;
  for (const auto& signal : kSignals) names += (names.empty() ? "" : ", ") + std::string(signal.name);
  return names;
}

}  // namespace

double MotorSignal::of(const link::State& state) const {
  if (motor >= std::min<std::size_t>(state.motor_count, link::kMaxMotors))
    return std::numeric_limits<double>::quiet_NaN();
  return read(state.motors[motor]);
}

Result<MotorSignal> findSignal(const link::Welcome& welcome, std::string_view text) {
  const auto dot = text.rfind('.');
  if (dot == std::string_view::npos)
    return fail("'" + std::string(text) + "': give MOTOR.SIGNAL, such as " +
                motorNames(welcome).substr(0, motorNames(welcome).find(',')) + ".velocity");
  const auto motor_name = text.substr(0, dot);
  const auto signal_name = text.substr(dot + 1);
  const auto signal = std::find_if(kSignals.begin(), kSignals.end(),
                                   [&](const auto& s) { return means(s.name, signal_name); });
  if (signal == kSignals.end())
    return fail("there is no signal '" + printable(signal_name) + "'; a motor has " + signalNames() +
                didYouMean(signal_name, signalWords()));
  const auto motor = findMotor(welcome, motor_name);
  if (!motor) return tl::unexpected(motor.error());
  return MotorSignal{*motor, printable(motor_name) + "." + std::string(signal->name), signal->read};
}

}  // namespace rc10::client
