#include "daemon/recording/flight_recorder.hpp"

#include <algorithm>
#include <cmath>

#include "app/motor_readings.hpp"
#include "daemon/devices/robot.hpp"

namespace rc10 {

void FlightRecorder::Tap::connect(FlightRecorder& recorder, std::uint8_t bus) noexcept {
  recorder_ = &recorder;
  bus_ = bus;
}

void FlightRecorder::Tap::onReceived(const CanFrame& frame) noexcept {
  recorder_->frame(frame, bus_, 0, frame.received);
}

void FlightRecorder::Tap::onSent(const CanFrame& frame, bool accepted) noexcept {
  const auto flags = accepted ? blackbox::kFrameSent : blackbox::kFrameSent | blackbox::kFrameRefused;
  recorder_->frame(frame, bus_, static_cast<std::uint8_t>(flags), recorder_->now_);
}

void FlightRecorder::listenTo(Robot& robot) noexcept {
  for (std::size_t i = 0; i < robot.buses().size(); ++i) {
    taps_[i].connect(*this, static_cast<std::uint8_t>(i));
    robot.buses()[i].bus->setTap(taps_[i]);
  }
}

void FlightRecorder::frame(const CanFrame& frame, std::uint8_t bus, std::uint8_t flags,
                           MonotonicTime time) noexcept {
  blackbox::Frame record;
  record.header.source = bus;
  record.header.time_ns = time.time_since_epoch().count();
  record.header.id = frame.id.value;
  if (frame.id.extended) record.header.id |= blackbox::kIdExtended;
  if (frame.type == FrameType::kRemote) record.header.id |= blackbox::kIdRemote;
  if (frame.type == FrameType::kError) record.header.id |= blackbox::kIdError;
  record.header.flags = static_cast<std::uint8_t>(
      flags | blackbox::lengthCode(frame.length) | (frame.fd ? blackbox::kFrameFd : 0) |
      (frame.bit_rate_switch ? blackbox::kFrameBitRateSwitch : 0));
  std::copy_n(frame.data.begin(), frame.length, record.data.begin());
  out_.write(record, sizeof record.header + frame.length);
}

void FlightRecorder::command(const Command& command, blackbox::Verdict verdict,
                             const std::bitset<kMaxMotors>& skipped) noexcept {
  blackbox::Command record;
  record.header.time_ns = nowNs();
  record.header.flags = static_cast<std::uint8_t>(verdict);
  record.header.id = static_cast<std::uint32_t>(command.count);
  record.client = command.client;
  record.session = command.session;
  record.deadline_ns = command.deadline.time_since_epoch().count();
  record.priority = command.priority;
  out_.write(record);
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto& target = command.setpoints[i].target;
    blackbox::Setpoint setpoint;
    setpoint.header.time_ns = nowNs();
    setpoint.header.source = static_cast<std::uint8_t>(command.setpoints[i].motor);
    setpoint.header.flags = skipped.test(i) ? blackbox::kSetpointSkipped : std::uint8_t{0};
    setpoint.header.id = static_cast<std::uint32_t>(target.mode);
    setpoint.value = target.value;
    setpoint.velocity_ff_rpm = target.velocity_ff_rpm;
    setpoint.torque_ff_nm = target.torque_ff_nm;
    setpoint.stiffness_nm_per_rad = target.stiffness_nm_per_rad;
    setpoint.damping_nms_per_rad = target.damping_nms_per_rad;
    const bool plain = target.velocity_ff_rpm == 0.0F && target.torque_ff_nm == 0.0F &&
                       target.stiffness_nm_per_rad == 0.0F && target.damping_nms_per_rad == 0.0F;
    out_.write(setpoint, plain ? blackbox::kPlainSetpointBytes : sizeof setpoint);
  }
}

void FlightRecorder::signals(const SignalMessage& message, blackbox::Verdict verdict) noexcept {
  const std::size_t place = verdict == blackbox::Verdict::kApplied ? 0 : 1;
  if (message.session == 0 && !isNew(message, last_signals_[message.module][place])) return;
  blackbox::Signals record;
  record.header.time_ns = nowNs();
  record.header.source = static_cast<std::uint8_t>(message.module);
  record.header.flags = static_cast<std::uint8_t>(verdict);
  record.client = message.client;
  record.session = message.session;
  record.deadline_ns = message.deadline.time_since_epoch().count();
  record.priority = message.priority;
  std::size_t count = 0;
  for (std::size_t input = 0; input < message.values.size(); ++input) {
    if (std::isnan(message.values[input])) continue;
    record.header.id |= 1U << input;
    record.values[count++] = message.values[input];
  }
  out_.write(record, blackbox::signalsBytes(count));
}

bool FlightRecorder::isNew(const SignalMessage& message, LastSignals& last) const noexcept {
  const bool same = now_ < last.until && last.client.equals(message.client) &&
                    std::equal(message.values.begin(), message.values.end(), last.values.begin(),
                               [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); });
  if (same) return false;
  last = {message.client, message.values, now_ + kSampleInterval};
  return true;
}

void FlightRecorder::order(const Order& order) noexcept {
  blackbox::Order record;
  record.header.time_ns = nowNs();
  record.header.flags = static_cast<std::uint8_t>(order.operation);
  record.header.source = order.whole_robot ? 1 : 0;
  for (std::size_t i = 0; i < order.motors.size(); ++i) {
    if (order.motors.test(i)) record.motors[i / 64] |= std::uint64_t{1} << (i % 64);
  }
  record.value = order.value;
  record.client = order.client;
  out_.write(record);
}

void FlightRecorder::event(const Event& event) noexcept {
  blackbox::Event record;
  record.header.time_ns = event.time.time_since_epoch().count();
  record.header.source = event.source < 0 ? blackbox::kNoSource : static_cast<std::uint8_t>(event.source);
  record.header.flags = static_cast<std::uint8_t>(event.severity);
  record.header.id = static_cast<std::uint32_t>(event.code);
  record.value = event.value;
  record.extra = event.extra;
  record.client = event.client;
  out_.write(record);
  if (event.code == EventCode::kMotorFault) {
    causes_.fetch_or(static_cast<std::uint32_t>(CopyCause::kFault), std::memory_order_relaxed);
  }
  if (event.code == EventCode::kRobotState && event.value == static_cast<std::int32_t>(RobotStatus::kEstop)) {
    causes_.fetch_or(static_cast<std::uint32_t>(CopyCause::kEstop), std::memory_order_relaxed);
  }
}

void FlightRecorder::states(const Snapshot& snapshot) noexcept {
  // Turns: the robot, its motors, its buses.
  turns_.advance(now_, 1 + snapshot.motor_count + snapshot.bus_count);
  if (turns_.due(0) || snapshot.state != robot_state_) {
    robot_state_ = snapshot.state;
    blackbox::Robot record;
    record.header.time_ns = nowNs();
    record.header.flags = static_cast<std::uint8_t>(snapshot.state);
    record.header.source = static_cast<std::uint8_t>(snapshot.stop.cause);
    record.header.id = snapshot.conditions;
    record.tick = snapshot.tick;
    record.missed_ticks = snapshot.missed_ticks;
    record.estops = snapshot.estops;
    out_.write(record);
  }
  for (std::size_t i = 0; i < snapshot.motor_count; ++i) {
    if (!turns_.due(1 + i) && snapshot.motors[i].status == statuses_[i]) continue;
    statuses_[i] = snapshot.motors[i].status;
    motor(snapshot.motors[i], snapshot.sent, static_cast<std::uint8_t>(i));
  }
  for (std::size_t i = 0; i < snapshot.bus_count; ++i) {
    if (!turns_.due(1 + snapshot.motor_count + i) && snapshot.buses[i].state == bus_states_[i]) continue;
    bus_states_[i] = snapshot.buses[i].state;
    bus(snapshot.buses[i], static_cast<std::uint8_t>(i));
  }
}

void FlightRecorder::motor(const MotorSnapshot& motor, MonotonicTime sent, std::uint8_t index) noexcept {
  blackbox::Motor record;
  record.header.time_ns = nowNs();
  record.header.source = index;
  record.header.flags = static_cast<std::uint8_t>(motor.status);
  record.header.id =
      static_cast<std::uint32_t>(motor.target.mode) | static_cast<std::uint32_t>(motor.command_unit) << 8U |
      (motor.feedback.zeroed ? 1U << 16U : 0U) | static_cast<std::uint32_t>(motor.acting) << 24U;
  record.target = motor.target.value;
  record.target_shaped = motor.target_shaped;
  blackbox::visitReadings(kCopyReading, record, motor.feedback);
  record.command_value = motor.command_value;
  record.limits = motor.limits;
  record.fault = static_cast<std::int32_t>(motor.fault);
  record.feedback_age_us = feedbackAgeUs(motor.feedback, now_);
  record.feedback_age_at_use_us = feedbackAgeUs(motor.feedback, sent);
  record.command_age_us = commandAgeUs(motor, now_);
  record.stop_cause = static_cast<std::uint32_t>(motor.stop.cause);
  out_.write(record);
}

void FlightRecorder::bus(const BusSnapshot& bus, std::uint8_t index) noexcept {
  blackbox::Bus record;
  record.header.time_ns = nowNs();
  record.header.source = index;
  record.header.flags = static_cast<std::uint8_t>(bus.state);
  record.rx_frames = bus.counters.rx_frames;
  record.tx_frames = bus.counters.tx_frames;
  record.tx_dropped = bus.counters.tx_dropped;
  record.error_frames = bus.error_frames;
  record.tec = bus.tec;
  record.rec = bus.rec;
  out_.write(record);
}

}  // namespace rc10
