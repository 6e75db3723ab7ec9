#pragma once

#include <sstream>
#include <string>
#include <variant>

#include "config/robot_config.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10::test {

namespace detail {

inline void print(std::ostream& out, const PID_Position::Config& c) {
  out << "position " << c.kp << ' ' << c.ki << ' ' << c.kd << ' ' << c.integral_limit << ' '
      << c.integral_separation << ' ' << c.deadband << ' ' << c.output_limit << ' ' << c.circular_period
      << ' ' << c.derivative_filter_hz << '\n';
}

inline void print(std::ostream& out, const PID_Incremental::Config& c) {
  out << "incremental " << c.kp << ' ' << c.ki << ' ' << c.kd << ' ' << c.deadband << ' ' << c.tracking_rad_s
      << ' ' << c.output_limit << ' ' << c.derivative_filter_hz << '\n';
}

inline void print(std::ostream& out, const MotorConfig& motor) {
  const MotorSettings& dji = motor.settings;
  const DjiModel& model = *findDjiModel(dji.model);
  const DjiCommand command = djiSettings(dji.own).command;
  const auto& table = model.command(command);
  // 0 and the model's own value say the same.
  out << "motor " << dji.name << ' ' << model.name << ' ' << dji.id << ' ' << static_cast<int>(command) << ' '
      << (dji.gear_ratio > 0.0 ? dji.gear_ratio : model.gear_ratio) << ' ' << dji.direction << ' '
      << (dji.effort_limit > 0.0F ? dji.effort_limit : table.full_scale) << ' ' << dji.zero_deg << ' '
      << dji.zero_at_power_on << ' ' << motor.settings.feedback_hz << ' ' << motor.feedback_timeout.count()
      << ' ' << motor.optional << ' ' << dji.loops.velocity_limit_rpm << ' ' << motor.guard.overspeed_rpm
      << ' ' << motor.guard.temperature_derate_c << ' ' << motor.guard.temperature_trip_c << ' '
      << motor.guard.stall_time.count() << ' ' << motor.guard.stall_trips << ' '
      << motor.guard.following_error_deg << ' ' << motor.guard.following_error_time.count() << '\n';
  const FallbackConfig& fallback = motor.fallback;
  out << fallback.brake_max.count() << ' ' << fallback.ramp.count() << ' '
      << static_cast<int>(fallback.on_timeout) << ' ' << static_cast<int>(fallback.on_disable) << ' '
      << static_cast<int>(fallback.on_estop) << ' ' << fallback.hold_max.count() << ' '
      << motor.run_down.count() << '\n';
  const ShapingConfig& shaping = motor.shaping;
  out << shaping.effort_slew_per_s << ' ' << shaping.velocity_slew_rpm_per_s << ' '
      << shaping.angle_slew_deg_per_s << ' ' << shaping.angle_min_deg << ' ' << shaping.angle_max_deg << ' '
      << shaping.max_first_step_deg << ' ' << shaping.soft_start_s << '\n';
  out << motor.reduced.velocity_rpm << ' ' << motor.reduced.within.count() << ' '
      << motor.reduced.effort_share << '\n';
  std::visit([&out](const auto& pid) { print(out, pid); }, dji.loops.velocity);
  print(out, dji.loops.angle);
  const auto& load = motor.simulated;
  out << load.inertia_kg_m2 << ' ' << load.viscous_nms_per_rad << ' ' << load.coulomb_nm << ' '
      << load.load_torque_nm << ' ' << load.gravity_nm << ' ' << load.hangs_at_deg << ' ' << load.stop_min_deg
      << ' ' << load.stop_max_deg << ' ' << load.initial_angle_deg << ' ' << load.stalled << ' '
      << load.silent << ' ' << load.lost_frames << ' ' << load.payload_kg << ' ' << load.payload_at_m << '\n';
  for (const auto& step : motor.load_plan.steps) {
    out << step.after.count();
    for (const auto& value : step.change.values) out << ' ' << value.value_or(-1.0F);
    out << '\n';
  }
  out << motor.load_plan.repeat.count() << ' ' << motor.simulated_id.value_or(-1) << '\n';
}

}  // namespace detail

/// Everything a configuration says, except where it stands: equal texts, equal robots.
inline std::string fingerprint(const RobotConfig& config) {
  std::ostringstream out;
  out.precision(17);
  out << config.robot << ' ' << static_cast<int>(config.realtime) << ' ' << static_cast<int>(config.guard)
      << ' ' << config.rate_hz << ' ' << config.scheduler.priority << ' ' << config.scheduler.cpu.value_or(-1)
      << ' ' << static_cast<int>(config.receive) << ' ' << static_cast<int>(config.timer) << ' '
      << config.phase_of_period << ' ' << config.rx_lead.count() << ' ' << config.overload.count() << ' '
      << config.rx.priority << ' ' << config.rx.cpu.value_or(-1) << ' ' << config.lcm.enabled << ' '
      << config.lcm.url << ' ' << config.lcm.state_hz << ' ' << config.blackbox_mib << '\n';
  for (const auto& contact : {config.estop_gpio, config.enabling_gpio, config.mode_gpio}) {
    if (contact) out << contact->pin.name() << ' ' << contact->closed_is_low << ' ' << contact->internal_bias;
    out << '\n';
  }
  if (const auto& heartbeat = config.heartbeat_gpio) {
    out << "heartbeat " << heartbeat->pin.name() << ' ' << heartbeat->period.count() << ' '
        << heartbeat->rests_in_estop_after.value_or(Duration{-1}).count() << '\n';
  }
  for (const auto& bus : config.buses) {
    out << "bus " << bus.name << ' ' << static_cast<int>(bus.type) << ' ' << bus.interface << ' '
        << bus.bitrate << ' ' << bus.data_bitrate << ' ' << bus.sample_point << ' ' << bus.data_sample_point
        << ' ' << bus.manage_link << ' ' << bus.sim_seed << '\n';
    for (const auto& motor : bus.motors) detail::print(out, motor);
  }
  for (const auto& group : config.groups) {
    out << "group " << group.name << ' ' << static_cast<int>(group.on_return)
        << (group.together ? " together" : "") << (group.implied ? " implied" : "");
    for (const auto motor : group.motors) out << ' ' << motor;
    out << '\n';
  }
  for (const auto& module : config.modules) {
    out << "module " << module.settings.name << ' ' << module.type->name() << ' ' << module.settings.priority
        << '\n';
    for (const auto& key : module.type->keys())
      out << key.name << ' ' << module.settings.own.number(key.name) << ' '
          << module.settings.own.text(key.name) << '\n';
  }
  return out.str();
}

}  // namespace rc10::test
