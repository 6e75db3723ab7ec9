#include "gateway/convert.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "client/sample_messages.hpp"
#include "gateway/udpm_datagram.hpp"
#include "link/link_message.hpp"
#include "link/words.hpp"

namespace rc10::gateway::test::convert_test {
namespace {

using rc10::test::heroDiagnostics;
using rc10::test::heroState;

link::Welcome welcomeOf(std::initializer_list<const char*> motors) {
  link::Welcome welcome;
  for (const char* motor : motors) welcome.motors[welcome.motor_count++].name = std::string_view{motor};
  return welcome;
}

// The message as a client reads it.
template <typename Message>
Message throughLcm(const Message& message) {
  static std::array<std::byte, kMaxPayload> buffer;
  const auto bytes = encode(message, buffer);
  EXPECT_FALSE(bytes.empty());
  Message copy{};
  EXPECT_EQ(copy.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return copy;
}

TEST(ConvertState, HasEveryField) {
  robot_state_t out{};
  convert(welcomeOf({"front_left", "yaw"}), heroState(), out);
  const auto copy = throughLcm(out);
  EXPECT_EQ(copy.utime, 1'700'000'000'000'000);
  EXPECT_EQ(copy.mono_us, 42'000'000);
  EXPECT_EQ(copy.tick, 41'000);
  EXPECT_EQ(copy.state, +robot_state_t::STATE_RUN);
  EXPECT_EQ(copy.realtime, 1);
  ASSERT_EQ(copy.motor_count, 2);
  const auto& wheel = copy.motors[0];
  EXPECT_EQ(wheel.name, "front_left");
  EXPECT_EQ(wheel.status, +motor_state_t::STATUS_ACTIVE);
  EXPECT_EQ(wheel.fault, 0);
  EXPECT_EQ(wheel.fault_text, "");
  EXPECT_EQ(wheel.limits, +motor_state_t::LIMIT_CURRENT);
  EXPECT_EQ(wheel.mode, 2);
  EXPECT_EQ(wheel.target, 120.0);
  EXPECT_EQ(wheel.owner, "teleop");
  EXPECT_EQ(wheel.zeroed, 0);
  EXPECT_EQ(wheel.angle_deg, 121.5F);
  EXPECT_EQ(wheel.total_angle_deg, 7321.5);
  EXPECT_EQ(wheel.velocity_rpm, 118.26F);
  EXPECT_EQ(wheel.current_a, 0.42F);
  EXPECT_EQ(wheel.torque_nm, 0.126F);
  EXPECT_TRUE(std::isnan(wheel.voltage_v));
  EXPECT_EQ(wheel.temperature_c, 31.0F);
  EXPECT_EQ(wheel.command_value, 0.43F);
  EXPECT_EQ(wheel.command_unit, +motor_state_t::UNIT_AMPERE);
  EXPECT_EQ(wheel.feedback_age_us, 420);
  EXPECT_EQ(wheel.feedback_age_at_use_us, 460);
  EXPECT_EQ(wheel.command_age_us, 5200);
  EXPECT_EQ(wheel.target_shaped, 119.0);
  EXPECT_EQ(wheel.acting, +motor_state_t::ACTING_TARGET);
  EXPECT_EQ(wheel.stop_cause, +motor_state_t::STOP_NONE);
  EXPECT_EQ(wheel.feedback_hz, 999.5F);
  const auto& yaw = copy.motors[1];
  EXPECT_EQ(yaw.status, +motor_state_t::STATUS_FAULT);
  EXPECT_EQ(yaw.fault, 12);
  EXPECT_EQ(yaw.stop_cause, +motor_state_t::STOP_FAULT);
  EXPECT_EQ(yaw.fault_text, link::faultText(12));
  EXPECT_TRUE(std::isnan(yaw.total_angle_deg));
  EXPECT_EQ(yaw.zeroed, 1);
  EXPECT_EQ(yaw.feedback_age_us, -1);
}

TEST(ConvertState, SaysWhoStoppedTheRobotAndWhatItRuns) {
  auto welcome = welcomeOf({"front_left", "yaw"});
  welcome.version = "0.2.0";
  welcome.config_hash = std::string(64, 'a');
  auto state = heroState();
  state.robot_state = RobotStatus::kEstop;
  state.stop_cause = StopCause::kRequest;
  state.stopped_by = "judge";
  state.conditions = kConditionSimulated;
  state.motors[1].stopped_by = "judge";
  robot_state_t out{};
  convert(welcome, state, out);
  const auto copy = throughLcm(out);
  EXPECT_EQ(copy.state, +robot_state_t::STATE_ESTOP);
  EXPECT_EQ(copy.stop_cause, +motor_state_t::STOP_REQUEST);
  EXPECT_EQ(copy.stopped_by, "judge");
  EXPECT_EQ(copy.stopped_mono_us, 41'000'000);
  EXPECT_EQ(copy.estop_count, 3);
  EXPECT_EQ(copy.conditions, +robot_state_t::CONDITION_SIMULATED);
  EXPECT_EQ(copy.version, "0.2.0");
  EXPECT_EQ(copy.config_hash, std::string(64, 'a'));
  EXPECT_EQ(copy.motors[1].stopped_by, "judge");
}

// The words of app/vocabulary.hpp are those of the types.
TEST(ConvertState, HasTheNumbersOfTheTypes) {
  EXPECT_EQ(static_cast<int>(Acting::kBrake), +motor_state_t::ACTING_BRAKE);
  EXPECT_EQ(static_cast<int>(Acting::kDamp), +motor_state_t::ACTING_DAMP);
  EXPECT_EQ(static_cast<int>(Acting::kHold), +motor_state_t::ACTING_HOLD);
  EXPECT_EQ(static_cast<int>(StopCause::kRequest), +motor_state_t::STOP_REQUEST);
  EXPECT_EQ(static_cast<int>(StopCause::kEstop), +motor_state_t::STOP_ESTOP);
  EXPECT_EQ(static_cast<int>(StopCause::kFault), +motor_state_t::STOP_FAULT);
  EXPECT_EQ(static_cast<int>(StopCause::kSilence), +motor_state_t::STOP_SILENCE);
  EXPECT_EQ(static_cast<int>(StopCause::kGroup), +motor_state_t::STOP_GROUP);
  EXPECT_EQ(static_cast<int>(StopCause::kTimeout), +motor_state_t::STOP_TIMEOUT);
  EXPECT_EQ(static_cast<int>(StopCause::kRefused), +motor_state_t::STOP_REFUSED);
  EXPECT_EQ(static_cast<int>(StopCause::kReference), +motor_state_t::STOP_REFERENCE);
  EXPECT_EQ(static_cast<int>(StopCause::kShutdown), +motor_state_t::STOP_SHUTDOWN);
  EXPECT_EQ(static_cast<int>(StopCause::kInput), +motor_state_t::STOP_INPUT);
  EXPECT_EQ(static_cast<int>(StopCause::kGuard), +motor_state_t::STOP_GUARD);
  EXPECT_EQ(static_cast<int>(StopCause::kOverload), +motor_state_t::STOP_OVERLOAD);
}

TEST(ConvertState, LeavesMotorsWithoutANameOut) {
  robot_state_t out{};
  auto state = heroState();
  state.motor_count = 0xFFFFFFFF;
  convert(welcomeOf({"front_left"}), state, out);
  EXPECT_EQ(throughLcm(out).motor_count, 1);
}

TEST(ConvertState, OfAReusedMessageHasNothingOfTheOneBefore) {
  robot_state_t out{};
  convert(welcomeOf({"front_left", "yaw"}), heroState(), out);
  auto state = heroState();
  state.motor_count = 1;
  state.motors[0].owner = "";
  convert(welcomeOf({"front_left", "yaw"}), state, out);
  const auto copy = throughLcm(out);
  ASSERT_EQ(copy.motors.size(), 1U);
  EXPECT_EQ(copy.motors[0].owner, "");
}

TEST(ConvertState, OfTheLargestRobotFitsOneDatagram) {
  link::Welcome welcome;
  link::State state;
  welcome.motor_count = state.motor_count = link::kMaxMotors;
  for (std::size_t i = 0; i < link::kMaxMotors; ++i) {
    welcome.motors[i].name = std::string(31, 'm');
    state.motors[i].owner = std::string(31, 'o');
    state.motors[i].stopped_by = std::string(31, 's');
    state.motors[i].fault = -2'000'000'000;
  }
  robot_state_t out{};
  convert(welcome, state, out);
  EXPECT_LE(static_cast<std::size_t>(out.getEncodedSize()) + kMaxChannelLength + 1, kMaxPayload);
}

TEST(ConvertDiagnostics, HasEveryField) {
  diagnostics_t out{};
  convert(heroDiagnostics(), out);
  const auto copy = throughLcm(out);
  EXPECT_EQ(copy.utime, 1'700'000'000'000'001);
  EXPECT_EQ(copy.mono_us, 42'000'001);
  EXPECT_EQ(copy.tick, 41'001);
  EXPECT_EQ(copy.tick_period_us, 1000);
  EXPECT_EQ(copy.wake_latency_p50_us, 4.1F);
  EXPECT_EQ(copy.wake_latency_p99_us, 38.5F);
  EXPECT_EQ(copy.wake_latency_p999_us, 61.0F);
  EXPECT_EQ(copy.wake_latency_max_us, 180.2F);
  EXPECT_EQ(copy.tick_duration_p50_us, 12.0F);
  EXPECT_EQ(copy.tick_duration_p99_us, 19.5F);
  EXPECT_EQ(copy.tick_duration_p999_us, 25.0F);
  EXPECT_EQ(copy.tick_duration_max_us, 70.0F);
  EXPECT_EQ(copy.missed_ticks, 2);
  EXPECT_EQ(copy.page_faults, 0);
  EXPECT_EQ(copy.events_dropped, 1);
  ASSERT_EQ(copy.refusal_count, 2);
  EXPECT_EQ(copy.refusals[0].name, "expired");
  EXPECT_EQ(copy.refusals[0].count, 3);
  ASSERT_EQ(copy.counter_count, 1);
  EXPECT_EQ(copy.counters[0].name, "e-stops");
  EXPECT_EQ(copy.counters[0].count, 4);
  ASSERT_EQ(copy.duration_count, 2);
  EXPECT_EQ(copy.durations[0].name, "command to frames");
  EXPECT_EQ(copy.durations[0].count, 41'000);
  EXPECT_EQ(copy.durations[0].p50_us, 420.0F);
  EXPECT_EQ(copy.durations[0].p99_us, 900.0F);
  EXPECT_EQ(copy.durations[0].p999_us, 950.0F);
  EXPECT_EQ(copy.durations[0].max_us, 1020.5F);
  EXPECT_EQ(copy.durations[1].name, "feedback at use: yaw");
  ASSERT_EQ(copy.notice_count, 1);
  EXPECT_EQ(copy.notices[0], "not real-time: no permission");
  ASSERT_EQ(copy.bus_count, 1);
  const auto& bus = copy.buses[0];
  EXPECT_EQ(bus.name, "chassis");
  EXPECT_EQ(bus.interface_name, "can0");
  EXPECT_EQ(bus.state, +bus_state_t::STATE_WARNING);
  EXPECT_EQ(bus.tec, 96);
  EXPECT_EQ(bus.rec, -1);
  EXPECT_EQ(bus.predicted_load, 0.556F);
  EXPECT_EQ(bus.predicted_load_worst, 0.676F);
  EXPECT_EQ(bus.measured_load, 0.548F);
  EXPECT_EQ(bus.rx_frames, 164'000);
  EXPECT_EQ(bus.rx_unmatched, 5);
  EXPECT_EQ(bus.rx_malformed, 1);
  EXPECT_EQ(bus.rx_foreign, 6);
  EXPECT_EQ(bus.tx_held, 8);
  EXPECT_EQ(bus.rx_dropped, 2);
  EXPECT_EQ(bus.tx_frames, 41'000);
  EXPECT_EQ(bus.tx_confirmed, 40'990);
  EXPECT_EQ(bus.tx_dropped, 3);
  EXPECT_EQ(bus.error_frames, 7);
  EXPECT_EQ(bus.restarts, 4);
}

TEST(ConvertDiagnostics, DoesNotBelieveTheCounts) {
  auto diagnostics = heroDiagnostics();
  diagnostics.refusal_count = diagnostics.counter_count = diagnostics.notice_count = diagnostics.bus_count =
      diagnostics.duration_count = 0xFFFFFFFF;
  diagnostics_t out{};
  convert(diagnostics, out);
  const auto copy = throughLcm(out);
  EXPECT_EQ(copy.refusals.size(), link::kMaxRefusalReasons);
  EXPECT_EQ(copy.counters.size(), link::kMaxCounters);
  EXPECT_EQ(copy.durations.size(), link::kMaxDurations);
  EXPECT_EQ(copy.notices.size(), link::kMaxNotices);
  EXPECT_EQ(copy.buses.size(), link::kMaxBuses);
}

TEST(ConvertEvent, HasEveryField) {
  link::Event event;
  event.utime = 1;
  event.mono_us = 2;
  event.severity = Severity::kError;
  event.code = 300;
  event.source = "chassis";
  event.text = "bus-off";
  event_t out{};
  convert(event, out);
  const auto copy = throughLcm(out);
  EXPECT_EQ(copy.utime, 1);
  EXPECT_EQ(copy.mono_us, 2);
  EXPECT_EQ(copy.severity, +event_t::SEVERITY_ERROR);
  EXPECT_EQ(copy.code, 300);
  EXPECT_EQ(copy.source, "chassis");
  EXPECT_EQ(copy.text, "bus-off");
}

TEST(ConvertResponse, HasEveryField) {
  link::Response response;
  response.client = "teleop";
  response.session = 0xFFFFFFFFFFFFFFF0;
  response.seq = 9;
  response.status = link::ResponseStatus::kRefused;
  response.message = "no";
  response.value_count = 1;
  response.values[0].name = "kp";
  response.values[0].value = 0.25;
  response_t out{};
  convert(response, 123, out);
  const auto copy = throughLcm(out);
  EXPECT_EQ(copy.utime, 123);
  EXPECT_EQ(copy.client, "teleop");
  EXPECT_EQ(copy.session, -16);
  EXPECT_EQ(copy.seq, 9);
  EXPECT_EQ(copy.status, +response_t::STATUS_REFUSED);
  EXPECT_EQ(copy.message, "no");
  ASSERT_EQ(copy.value_count, 1);
  EXPECT_EQ(copy.values[0].name, "kp");
  EXPECT_EQ(copy.values[0].value, 0.25);
}

TEST(Encode, IntoTooSmallABufferGivesNothing) {
  event_t event{};
  event.text = std::string(100, 'x');
  std::array<std::byte, 64> small;
  EXPECT_TRUE(encode(event, small).empty());
}

}  // namespace
}  // namespace rc10::gateway::test::convert_test
