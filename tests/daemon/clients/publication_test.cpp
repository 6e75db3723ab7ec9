#include "daemon/clients/publication.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "rc10_version.hpp"

namespace rc10::test::publication_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class PublicationTest : public ::testing::Test {
 protected:
  PublicationTest() {
    robot.robot = "hero";
    robot.lcm_url = "udpm://239.255.76.67:7667?ttl=0";
    robot.rate_hz = 500;
    robot.state_hz = 100;
    robot.buses = {{"chassis", "can0", 1e6, 0.5F, 0.6F}, {"arm", "", 5e5, 0.1F, 0.2F}};
    robot.motors = {{"left", "M3508", 0, 1, ModeSet{ControlMode::kCurrent}}, {"elbow", "GM6020", 1, 5, {}}};
    snapshot->time = MonotonicTime{100s};
    snapshot->motor_count = 2;
    snapshot->bus_count = 2;
  }
  const link::State& state() {
    publication.fill(*state_, *snapshot, 123);
    return *state_;
  }
  const link::Diagnostics& diagnostics() {
    publication.fill(*diagnostics_, *snapshot,
                     {.timing = timing,
                      .ages = ages,
                      .state_ages = state_ages,
                      .late = late,
                      .inboxes = inboxes,
                      .admission = admission,
                      .notices = notices,
                      .page_faults = 17},
                     456);
    return *diagnostics_;
  }
  std::int64_t refusals(std::string_view name) {
    const auto& message = diagnostics();
    for (std::size_t i = 0; i < message.refusal_count; ++i) {
      if (message.refusals[i].name.view() == name) return message.refusals[i].count;
    }
    return -1;
  }

  RobotDescription robot;
  std::vector<std::string> notices;
  TickTiming timing;
  TickAges ages;
  std::array<BusInbox, kMaxBuses> inboxes;
  Admission admission{robot};
  std::unique_ptr<Snapshot> snapshot = std::make_unique<Snapshot>();
  std::unique_ptr<link::State> state_ = std::make_unique<link::State>();
  std::unique_ptr<link::Diagnostics> diagnostics_ = std::make_unique<link::Diagnostics>();
  DurationHistogram state_ages;
  LateTickCauses late;
  Publication publication{robot};
};

TEST_F(PublicationTest, TheWelcomeDescribesTheRobot) {
  const auto welcome = publication.welcome();
  EXPECT_EQ(welcome.pid, ::getpid());
  EXPECT_EQ(welcome.robot.view(), "hero");
  EXPECT_EQ(welcome.version.view(), kVersion);
  EXPECT_EQ(welcome.lcm_url.view(), robot.lcm_url);
  EXPECT_EQ(welcome.rate_hz, 500);
  EXPECT_EQ(welcome.state_hz, 100);
  ASSERT_EQ(welcome.motor_count, 2U);
  EXPECT_EQ(welcome.motors[0].name.view(), "left");
  EXPECT_EQ(welcome.motors[0].modes, 1U << 1U);
  EXPECT_EQ(welcome.motors[1].model.view(), "GM6020");
  EXPECT_EQ(welcome.motors[1].bus.view(), "arm");
  EXPECT_EQ(welcome.motors[1].id, 5);
}

TEST_F(PublicationTest, TheStateCarriesTheSnapshotOfTheTick) {
  snapshot->tick = 99;
  snapshot->state = RobotStatus::kEstop;
  auto& motor = snapshot->motors[1];
  motor.status = MotorStatus::kActive;
  motor.target = {.mode = ControlMode::kVelocity, .value = 120.0};
  motor.command_unit = CommandUnit::kAmpere;
  motor.command_value = 2.5F;
  motor.limits = kLimitCurrent | kLimitStall;
  motor.owner = "planner";
  motor.feedback = {.received = snapshot->time - 750us,
                    .samples = 5,
                    .total_angle_deg = 361.0,
                    .angle_deg = 1.0F,
                    .velocity_rpm = 2.0F,
                    .current_a = 3.0F,
                    .torque_nm = 4.0F,
                    .voltage_v = 5.0F,
                    .temperature_c = 6.0F,
                    .zeroed = true};
  const auto& out = state();
  EXPECT_EQ(out.utime, 123);
  EXPECT_EQ(out.mono_us, 100'000'000);
  EXPECT_EQ(out.tick, 99);
  EXPECT_EQ(out.robot_state, RobotStatus::kEstop);
  EXPECT_EQ(out.realtime, 1);
  ASSERT_EQ(out.motor_count, 2U);
  const auto& shown = out.motors[1];
  EXPECT_EQ(shown.status, MotorStatus::kActive);
  EXPECT_EQ(shown.mode, ControlMode::kVelocity);
  EXPECT_EQ(shown.command_unit, CommandUnit::kAmpere);
  EXPECT_EQ(shown.zeroed, 1);
  EXPECT_EQ(shown.limits, kLimitCurrent | kLimitStall);
  EXPECT_EQ(shown.feedback_age_us, 750);
  EXPECT_EQ(shown.target, 120.0);
  EXPECT_EQ(shown.angle_deg, 1.0F);
  EXPECT_EQ(shown.total_angle_deg, 361.0);
  EXPECT_EQ(shown.velocity_rpm, 2.0F);
  EXPECT_EQ(shown.current_a, 3.0F);
  EXPECT_EQ(shown.torque_nm, 4.0F);
  EXPECT_EQ(shown.voltage_v, 5.0F);
  EXPECT_EQ(shown.temperature_c, 6.0F);
  EXPECT_EQ(shown.command_value, 2.5F);
  EXPECT_EQ(shown.owner.view(), "planner");
}

TEST_F(PublicationTest, AgesOfCommandsAreToldByClient) {
  ages.clients.record(link::Name{"teleop"}, 2ms);
  ages.clients.record(link::Name{"planner"}, 3ms);
  const auto named = [this] {
    const auto& out = diagnostics();
    std::vector<std::string> names;
    for (const auto& each : std::span{out.durations}.first(out.duration_count))
      if (each.name.view().starts_with("command of ")) names.emplace_back(each.name.view());
    return names;
  };
  EXPECT_THAT(named(), ElementsAre("command of teleop", "command of planner"));
  for (std::size_t i = 0; i < ClientAges::kNamed; ++i)
    ages.clients.record(link::Name{"script" + std::to_string(i)}, 1ms);
  EXPECT_EQ(named().size(), ClientAges::kNamed + 1);
  EXPECT_EQ(named().back(), "command of further clients");
}

TEST_F(PublicationTest, AgesOfFeedbackAreToldByBusAndByMotor) {
  robot.motors.push_back({"right", "M3508", 0, 2, {}});
  ages.feedback = std::vector<DurationHistogram>(3);
  for (int i = 0; i < 3; ++i) ages.feedback[0].record(1ms);
  ages.feedback[1].record(9ms);
  ages.feedback[2].record(4ms);
  ages.command.record(2ms);
  for (int i = 0; i < 2; ++i) state_ages.record(6ms);
  const auto& out = diagnostics();
  std::vector<std::string> told;
  for (const auto& each : std::span{out.durations}.first(out.duration_count)) {
    const auto& of = each.percentiles;
    // Upper edges of bins, up to 6 % too high.
    told.push_back(fmt::format("{}: {} of {:.0f} to {:.0f} ms", each.name.view(), each.count,
                               std::floor(of.p50_us / 1000), std::floor(of.max_us / 1000)));
  }
  EXPECT_THAT(
      told, ElementsAre("command to frames: 1 of 2 to 2 ms", "feedback to clients: 2 of 6 to 6 ms",
                        "feedback at use, bus chassis: 4 of 1 to 4 ms",
                        "feedback at use, bus arm: 1 of 9 to 9 ms", "feedback at use: left: 3 of 1 to 1 ms",
                        "feedback at use: elbow: 1 of 9 to 9 ms", "feedback at use: right: 1 of 4 to 4 ms"));
}

TEST_F(PublicationTest, ARobotThatIsNotRealTimeSaysSoInEveryState) {
  robot.realtime = false;
  EXPECT_EQ(state().realtime, 0);
}

TEST_F(PublicationTest, LockedTuningIsAConditionInEveryState) {
  robot.buses[1].interface = "can1";
  snapshot->conditions = kConditionReduced;
  EXPECT_EQ(state().conditions, kConditionReduced);
  robot.tuning_locked_at = 3;
  EXPECT_EQ(state().conditions, kConditionReduced | kConditionTuningLocked);
}

TEST_F(PublicationTest, WithoutAnySampleThereIsNoAge) { EXPECT_EQ(state().motors[0].feedback_age_us, -1); }

TEST_F(PublicationTest, AnAgeIsNeverNegativeAndNeverOverflows) {
  auto& feedback = snapshot->motors[0].feedback;
  feedback.samples = 1;
  feedback.received = snapshot->time + 1ms;
  EXPECT_EQ(state().motors[0].feedback_age_us, 0);
  snapshot->time += 24h;
  EXPECT_EQ(state().motors[0].feedback_age_us, INT32_MAX);
}

TEST_F(PublicationTest, TheFeedbackRateIsThatOfTheLastSecond) {
  auto& feedback = snapshot->motors[1].feedback;
  feedback.samples = 5000;
  EXPECT_EQ(state().motors[1].feedback_hz, 0.0F) << "not known yet";
  for (int i = 0; i < 200; ++i) {
    snapshot->time += 5ms;
    feedback.samples += 5;
    (void)state();
  }
  EXPECT_FLOAT_EQ(state().motors[1].feedback_hz, 1000.0F);
  snapshot->time += 1s;  // not one sample more
  EXPECT_EQ(state().motors[1].feedback_hz, 0.0F);
}

TEST_F(PublicationTest, ARateIsMeasuredOverTheTimeThatPassed) {
  RateMeter meter;
  (void)meter.update(MonotonicTime{10s}, 100);
  EXPECT_EQ(meter.update(MonotonicTime{10999ms}, 5000), 0.0F) << "not a second yet";
  EXPECT_FLOAT_EQ(meter.update(MonotonicTime{12s}, 4100), 2000.0F);
  EXPECT_FLOAT_EQ(meter.update(MonotonicTime{12500ms}, 9999), 2000.0F) << "kept until the next";
  EXPECT_NEAR(meter.update(MonotonicTime{12'999'990us}, 5100), 1000.0F, 0.1F) << "a second, by a timer";
}

TEST_F(PublicationTest, DiagnosticsCountLateTicksByCause) {
  LateTicks ticks;
  const ThreadFacts thread{.waited = [] { return std::nullopt; }, .page_faults = [] { return 0U; }};
  late.update(ticks, 20, thread);
  ticks.record(TickStep::kSend, 700us);
  late.update(ticks, 40, thread);
  const auto& out = diagnostics();
  std::map<std::string, std::int64_t> counted;
  for (const auto& counter : std::span{out.counters}.first(out.counter_count))
    counted[std::string(counter.name.view())] = counter.count;
  EXPECT_EQ(counted.at("late ticks: sending"), 1);
  EXPECT_EQ(counted.at("late ticks: timer"), 0);
}

TEST_F(PublicationTest, DiagnosticsCarryTimingAndCounts) {
  for (int i = 0; i < 1000; ++i) timing.wake_latency.record(10us);
  timing.duration.record(30us);
  snapshot->tick = 1000;
  snapshot->missed_ticks = 3;
  snapshot->events_dropped = 4;
  const auto& out = diagnostics();
  EXPECT_EQ(out.utime, 456);
  EXPECT_EQ(out.mono_us, 100'000'000);
  EXPECT_EQ(out.tick, 1000);
  EXPECT_EQ(out.tick_period_us, 2000);
  EXPECT_NEAR(out.wake_latency.p50_us, 10.0F, 0.7F);
  EXPECT_EQ(out.wake_latency.max_us, 10.0F);
  EXPECT_EQ(out.tick_duration.max_us, 30.0F);
  EXPECT_EQ(out.missed_ticks, 3);
  EXPECT_EQ(out.page_faults, 17);
  EXPECT_EQ(out.events_dropped, 4);
}

TEST_F(PublicationTest, DiagnosticsCountRefusalsByReason) {
  admission.count(CommandRefusal::kNone);
  admission.count(CommandRefusal::kUnknownMotor);
  admission.count(CommandRefusal::kUnknownMotor);
  snapshot->skipped_setpoints = 6;
  EXPECT_EQ(refusals("unknown motor"), 2);
  EXPECT_EQ(refusals("too many commands"), 0);
  EXPECT_EQ(refusals("setpoint skipped"), 6);
  EXPECT_EQ(refusals("accepted"), -1);
}

TEST_F(PublicationTest, ExpiredOnArrivalAndExpiredInTheRingAreOneReason) {
  admission.count(CommandRefusal::kExpired);
  snapshot->expired_commands = 2;
  EXPECT_EQ(refusals("expired"), 3);
}

TEST_F(PublicationTest, RepeatedDiagnosticsDoNotGrow) {
  const auto count = diagnostics().refusal_count;
  EXPECT_EQ(diagnostics().refusal_count, count);
  EXPECT_LE(count, link::kMaxRefusalReasons);
}

TEST_F(PublicationTest, NoticesBeyondTheRoomAreLeftOut) {
  robot.notices = {"one", "two", "three", "four", "five"};
  const auto& out = diagnostics();
  ASSERT_EQ(out.notice_count, link::kMaxNotices);
  EXPECT_EQ(out.notices[3].view(), "four");
}

TEST_F(PublicationTest, ANoticeOfThisMomentComesBeforeThoseOfTheStart) {
  robot.notices = {"one", "two", "three", "four"};
  notices = {"now"};
  const auto& out = diagnostics();
  ASSERT_EQ(out.notice_count, link::kMaxNotices);
  EXPECT_EQ(out.notices[0].view(), "now");
  EXPECT_EQ(out.notices[3].view(), "three");
}

TEST_F(PublicationTest, ABusShowsItsCountersFromBothSidesOfTheRing) {
  auto& in = snapshot->buses[0];
  in.state = BusState::kPassive;
  in.tec = 130;
  in.rec = 2;
  in.error_frames = 9;
  in.restarts = 1;
  in.counters = {.rx_frames = 100,
                 .rx_unmatched = 5,
                 .rx_malformed = 2,
                 .rx_foreign = 4,
                 .tx_frames = 50,
                 .tx_dropped = 3,
                 .tx_held = 6};
  inboxes[0].malformed = 40;
  inboxes[0].dropped = 7;
  inboxes[0].confirmed = 49;
  const auto& out = diagnostics();
  ASSERT_EQ(out.bus_count, 2U);
  const auto& bus = out.buses[0];
  EXPECT_EQ(bus.name.view(), "chassis");
  EXPECT_EQ(bus.interface.view(), "can0");
  EXPECT_EQ(bus.state, BusState::kPassive);
  EXPECT_EQ(bus.tec, 130);
  EXPECT_EQ(bus.rec, 2);
  EXPECT_EQ(bus.predicted_load, 0.5F);
  EXPECT_EQ(bus.predicted_load_worst, 0.6F);
  EXPECT_EQ(bus.rx_frames, 100);
  EXPECT_EQ(bus.rx_unmatched, 5);
  EXPECT_EQ(bus.rx_malformed, 42);
  EXPECT_EQ(bus.rx_foreign, 4);
  EXPECT_EQ(bus.rx_dropped, 7);
  EXPECT_EQ(bus.tx_frames, 50);
  EXPECT_EQ(bus.tx_confirmed, 49);
  EXPECT_EQ(bus.tx_dropped, 3);
  EXPECT_EQ(bus.tx_held, 6);
  EXPECT_EQ(bus.error_frames, 9);
  EXPECT_EQ(bus.restarts, 1);
  EXPECT_EQ(out.buses[1].interface.view(), "simulated");
}

TEST_F(PublicationTest, TheMeasuredLoadIsThatOfBothDirectionsAtTheBitRate) {
  (void)diagnostics();
  snapshot->time += 2s;
  snapshot->buses[1].counters.rx_bits = 300'000;
  snapshot->buses[1].counters.tx_bits = 200'000;
  EXPECT_FLOAT_EQ(diagnostics().buses[1].measured_load, 0.5F);  // 250 kbit/s of 500
}

TEST_F(PublicationTest, AnEventNamesItsSource) {
  const auto source = [&](EventCode code, std::int16_t index) {
    return std::string(publication.event({code, Severity::kInfo, index, 0, 0, {}}, 1).source.view());
  };
  EXPECT_EQ(source(EventCode::kRobotState, -1), "robot");
  EXPECT_EQ(source(EventCode::kMotorStatus, 1), "elbow");
  EXPECT_EQ(source(EventCode::kBusState, 1), "arm");
  EXPECT_EQ(source(EventCode::kMotorStatus, 2), "?");
  EXPECT_EQ(source(EventCode::kBusState, 2), "?");
  EXPECT_EQ(source(EventCode::kForeignSender, 0), "chassis");
}

TEST_F(PublicationTest, AFirstStepThatIsTooFarIsToldWithItsBound) {
  robot.motors[1].max_first_step_deg = 12.5;
  const Event skipped{EventCode::kSetpointSkipped,
                      Severity::kWarning,
                      1,
                      static_cast<std::int32_t>(SkipReason::kFirstStep),
                      static_cast<std::int32_t>(ControlMode::kAngle),
                      MonotonicTime{2s}};
  EXPECT_EQ(publication.event(skipped, 1).text.view(),
            "setpoint angle skipped: farther from where the motor is than max_first_step_deg; begin near the "
            "measured angle: within 12.5 deg");
}

TEST_F(PublicationTest, AnEventOfAnInputNamesItsLine) {
  robot.estop_input = "gpiochip0:17";
  robot.mode_input = "gpiochip0:23";
  EXPECT_EQ(publication.event(modeInputEvent(ContactState::kOpen, {}), 1).source.view(), "gpiochip0:23");
  EXPECT_EQ(publication.event(estopInputEvent(ContactState::kOpen, {}), 1).source.view(), "gpiochip0:17");
}

TEST_F(PublicationTest, AnEventCarriesItsTimeSeverityCodeAndWords) {
  const auto event =
      publication.event({EventCode::kTicksMissed, Severity::kWarning, -1, 12, 0, MonotonicTime{2s}}, 789);
  EXPECT_EQ(event.utime, 789);
  EXPECT_EQ(event.mono_us, 2'000'000);
  EXPECT_EQ(event.severity, Severity::kWarning);
  EXPECT_EQ(event.code, 201);
  EXPECT_THAT(std::string(event.text.view()), HasSubstr("12"));
}

}  // namespace
}  // namespace rc10::test::publication_test
