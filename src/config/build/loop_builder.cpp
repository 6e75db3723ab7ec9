#include "config/build/loop_builder.hpp"

#include <variant>

#include "config/keys/loop_gains.hpp"

namespace rc10 {
namespace {

using VelocityConfig = std::variant<PID_Incremental::Config, PID_Position::Config>;

/// Fields that both forms have. Gains are per second in both.
template <typename To, typename From>
To carriedOver(const From& from) {
  To to;
  to.kp = from.kp;
  to.ki = from.ki;
  to.kd = from.kd;
  to.deadband = from.deadband;
  to.output_limit = from.output_limit;
  to.derivative_filter_hz = from.derivative_filter_hz;
  return to;
}

VelocityConfig ofType(bool incremental, const VelocityConfig& defaults) {
  if (std::holds_alternative<PID_Incremental::Config>(defaults) == incremental) return defaults;
  if (incremental) return carriedOver<PID_Incremental::Config>(std::get<PID_Position::Config>(defaults));
  return carriedOver<PID_Position::Config>(std::get<PID_Incremental::Config>(defaults));
}

}  // namespace

bool wantsIncremental(const Settings& motor, const CascadeConfig& defaults) {
  const auto type = motor.section("velocity_pid").text("type");
  return type.empty() ? std::holds_alternative<PID_Incremental::Config>(defaults.velocity)
                      : type == "incremental";
}

CascadeConfig buildLoops(const Settings& motor, const CascadeConfig& defaults, bool volts) {
  CascadeConfig loops = defaults;
  loops.velocity = ofType(wantsIncremental(motor, loops), loops.velocity);
  const std::uint16_t foreign = volts ? kNeedsCurrent : kNeedsVoltage;
  for (const auto& gain : allGainKeys()) {
    float* value = (gain.key->needs & foreign) == 0 ? gainIn(loops, gain.gain) : nullptr;
    if (value != nullptr) motor.section(gain.loop).read(gain.key->name, *value);
  }
  motor.read("velocity_limit_rpm", loops.velocity_limit_rpm);
  return loops;
}

}  // namespace rc10
