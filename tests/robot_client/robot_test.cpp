#include "rc10/robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_rc10d.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::robot_test {
namespace {

using namespace std::chrono_literals;
using namespace rc10::literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = RequestError::Kind;
using Outcome = MoveResult::Outcome;

/// A robot and its rc10d on one memq link. Validity and silence are long: this machine may pause.
class RobotTest : public testing::Test {
 protected:
  static RobotOptions options() {
    RobotOptions options;
    options.client = "tester";
    options.priority = 7;
    options.validity = 1000ms;
    options.on_problem = [](const std::string&) {};
    return options;
  }

  void connect(RobotOptions options = RobotTest::options()) {
    robot_ = std::make_unique<Robot>("hero", link_, std::move(options));
    ASSERT_TRUE(robot_->status()) << robot_->status().error().message;
  }
  /// Has a state published and waits until the robot has it: handlers are called in the order in which they
  /// were subscribed.
  void see(std::chrono::milliseconds after = 5ms) {
    std::promise<void> seen;
    auto future = seen.get_future();
    bool first = true;
    const auto last = link_.subscribe(rc10d_.channel("state"), [&](auto) {
      if (std::exchange(first, false)) seen.set_value();
    });
    rc10d_.publishState(after);
    ASSERT_EQ(future.wait_for(kPatience), std::future_status::ready);
  }
  void connectEnabled(RobotOptions options = RobotTest::options()) {
    connect(std::move(options));
    ASSERT_TRUE(robot_->enable());
  }
  motor_state_t& fakeMotor(const std::string& name) { return rc10d_.motors[name]; }

  LcmLink link_{"memq://"};
  FakeRc10d rc10d_{link_};
  std::unique_ptr<Robot> robot_;
};

TEST_F(RobotTest, SendsATargetWithWhoWhenAndHowLong) {
  connectEnabled();
  ASSERT_TRUE(robot_->motor("lift").setTargetTotalAngle(720_deg));
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  const auto command = rc10d_.commands()[0];
  EXPECT_EQ(command.client, "tester");
  EXPECT_EQ(command.priority, 7);
  EXPECT_EQ(command.validity_ms, 1000);
  EXPECT_GT(command.session, 0);
  ASSERT_EQ(command.setpoint_count, 1);
  EXPECT_EQ(command.setpoints[0].motor, "lift");
  EXPECT_EQ(command.setpoints[0].mode, +setpoint_t::MODE_TOTAL_ANGLE);
  EXPECT_EQ(command.setpoints[0].value, 720.0);
}

TEST_F(RobotTest, SendsEveryModeInItsUnit) {
  connectEnabled();
  const auto lift = robot_->motor("lift");
  ASSERT_TRUE(lift.setTargetCurrent(500_mA));
  ASSERT_TRUE(lift.setTargetRPM(120_rpm, {.torque_nm = 0.25}));
  ASSERT_TRUE(lift.setTargetAngle(90_deg, {.velocity = 10_rpm}));
  ASSERT_TRUE(lift.setTargetImpedance(45_deg, 2.5, 0.125));
  ASSERT_TRUE(lift.setTargetVoltage(6_V));
  ASSERT_TRUE(lift.setTargetDuty(-0.5));
  ASSERT_TRUE(lift.brake());
  ASSERT_TRUE(lift.coast());
  const auto sent = [&](std::int8_t mode, double value) {
    return rc10d_.awaitCommand([=](const command_t& command) {
      return command.setpoints[0].mode == mode && command.setpoints[0].value == value;
    });
  };
  EXPECT_TRUE(sent(setpoint_t::MODE_CURRENT, 0.5));
  EXPECT_TRUE(sent(setpoint_t::MODE_VELOCITY, 120.0));
  EXPECT_TRUE(sent(setpoint_t::MODE_ANGLE, 90.0));
  EXPECT_TRUE(sent(setpoint_t::MODE_IMPEDANCE, 45.0));
  EXPECT_TRUE(sent(setpoint_t::MODE_VOLTAGE, 6.0));
  EXPECT_TRUE(sent(setpoint_t::MODE_DUTY, -0.5));
  EXPECT_TRUE(sent(setpoint_t::MODE_BRAKE, 0.0));
  EXPECT_TRUE(sent(setpoint_t::MODE_COAST, 0.0));
  EXPECT_TRUE(rc10d_.awaitCommand([](const command_t& c) { return c.setpoints[0].torque_ff_nm == 0.25F; }));
  EXPECT_TRUE(
      rc10d_.awaitCommand([](const command_t& c) { return c.setpoints[0].velocity_ff_rpm == 10.0F; }));
  EXPECT_TRUE(
      rc10d_.awaitCommand([](const command_t& c) { return c.setpoints[0].stiffness_nm_per_rad == 2.5F; }));
}

TEST_F(RobotTest, HoldsATargetWithGrowingNumbers) {
  connectEnabled();
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(rc10d_.awaitCommands(4));
  const auto commands = rc10d_.commands();
  for (std::size_t i = 1; i < commands.size(); ++i) {
    EXPECT_GT(commands[i].seq, commands[i - 1].seq);
    EXPECT_EQ(commands[i].session, commands[0].session);
    EXPECT_EQ(commands[i].setpoints[0].value, 60.0);
  }
}

TEST_F(RobotTest, SeveralSetpointsTravelInOneMessage) {
  connectEnabled();
  ASSERT_TRUE(
      robot_->command({{"lift", Setpoint::totalAngle(10_deg)}, {"wheel", Setpoint::velocity(60_rpm)}}));
  ASSERT_TRUE(rc10d_.awaitCommands(2));
  for (const auto& command : rc10d_.commands()) EXPECT_EQ(command.setpoint_count, 2);
}

TEST_F(RobotTest, SendsNothingIfOneOfTheSetpointsCannotAct) {
  connect();
  ASSERT_TRUE(robot_->enable({"lift"}));
  const auto done = robot_->command({{"lift", Setpoint::brake()}, {"wheel", Setpoint::velocity(60_rpm)}});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "wheel is READY: enable it first");
  EXPECT_FALSE(robot_->command({}));
  EXPECT_FALSE(robot_->command({{"lift", Setpoint::brake()}, {"lift", Setpoint::coast()}}));
  EXPECT_FALSE(robot_->motor("lift").setTargetRPM(Rpm{kUnknown}));
  EXPECT_THAT(robot_->motor("lft").brake().error().message, HasSubstr("the motors are: lift, wheel, yaw"));
  EXPECT_THAT(rc10d_.commands(), IsEmpty());
}

TEST_F(RobotTest, SendsNothingBeforeTheFirstState) {
  connect();
  const auto done = robot_->motor("lift").brake();
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("waitForState()"));
}

TEST_F(RobotTest, AProblemThatTheProgramIgnoresIsTold) {
  auto options = RobotTest::options();
  std::promise<std::string> told;
  options.on_problem = [&](const std::string& text) { told.set_value(text); };
  connect(options);
  see();
  (void)robot_->motor("lift").brake();
  (void)robot_->motor("lift").brake();  // once a second
  EXPECT_EQ(told.get_future().get(), "lift is READY: enable it first");
}

TEST_F(RobotTest, AMotorThatWasLostIsNotDrivenWhenItIsBack) {
  connectEnabled();
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("wheel").status = motor_state_t::STATUS_OFFLINE;
  }
  see(10s);
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("wheel").status = motor_state_t::STATUS_ACTIVE;
  }
  see();
  ASSERT_TRUE(robot_->motor("lift").brake());
  ASSERT_TRUE(
      rc10d_.awaitCommand([](const command_t& command) { return command.setpoints[0].motor == "lift"; }));
  {
    const std::lock_guard lock(rc10d_.mutex);
    rc10d_.received.clear();
  }
  ASSERT_TRUE(rc10d_.awaitCommands(3));
  for (const auto& command : rc10d_.commands()) EXPECT_EQ(command.setpoints[0].motor, "lift");
}

TEST_F(RobotTest, LetsGoWhenTheProgramShowsNoLife) {
  auto options = RobotTest::options();
  std::promise<std::string> told;
  options.alive_within = 50ms;
  options.on_problem = [&](const std::string& text) { told.set_value(text); };
  connectEnabled(options);
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  EXPECT_THAT(told.get_future().get(), HasSubstr("wheel is let go of"));
}

// ---- states

TEST_F(RobotTest, ShowsTheStateWithItsAgeAndNanForWhatIsNotReported) {
  connect();
  EXPECT_EQ(robot_->state(), nullptr);
  const auto unknown = robot_->motor("lift").state();
  EXPECT_EQ(unknown.status, MotorStatus::kOffline);
  EXPECT_TRUE(std::isnan(unknown.velocity_rpm));
  see();
  const auto lift = robot_->motor("lift").state();
  EXPECT_EQ(lift.status, MotorStatus::kReady);
  EXPECT_EQ(lift.velocity_rpm, 12.5);
  EXPECT_TRUE(std::isnan(lift.voltage_v));
  EXPECT_GE(robot_->state()->age(), 0ns);
}

TEST_F(RobotTest, CallsBackForEveryStateAndEvent) {
  connect();
  std::promise<std::int64_t> tick;
  std::promise<std::string> text;
  robot_->onState([&](const RobotState& state) {
    tick.set_value(state.tick);
    robot_->onState(nullptr);
  });
  robot_->onEvent([&](const Event& event) { text.set_value(event.text); });
  see();
  EXPECT_EQ(tick.get_future().get(), robot_->state()->tick);
  rc10d_.publishEvent(100, "lift", "READY (was OFFLINE)");
  EXPECT_EQ(text.get_future().get(), "READY (was OFFLINE)");
}

TEST_F(RobotTest, ATargetMayBeSetInACallback) {
  connectEnabled();
  robot_->onState([&](const RobotState&) { (void)robot_->motor("wheel").setTargetRPM(42_rpm); });
  rc10d_.publishState();
  EXPECT_TRUE(
      rc10d_.awaitCommand([](const command_t& command) { return command.setpoints[0].value == 42.0; }));
}

TEST_F(RobotTest, WaitingInACallbackIsAnErrorAndNoDeadlock) {
  connect();
  std::promise<std::string> waited;
  std::promise<std::string> enabled;
  robot_->onState([&](const RobotState&) {
    waited.set_value(robot_->waitForState().error().message);
    enabled.set_value(robot_->enable().error().message);
    robot_->onState(nullptr);
  });
  rc10d_.publishState();
  EXPECT_EQ(waited.get_future().get(), "waitForState() in a callback would wait for itself");
  EXPECT_EQ(enabled.get_future().get(), "enable in a callback would wait for itself");
}

TEST_F(RobotTest, TellsAWrongNameFromASilentDaemon) {
  Robot wrong("heros", link_, options());
  const auto silent = wrong.waitForState(1ms);
  ASSERT_FALSE(silent);
  EXPECT_THAT(silent.error().message, HasSubstr("is rc10d running"));
  std::promise<void> stop;
  auto stopped = stop.get_future().share();
  std::thread publishing([&] {
    while (stopped.wait_for(2ms) == std::future_status::timeout) rc10d_.publishState();
  });
  const auto heard = wrong.waitForState(20ms);
  stop.set_value();
  publishing.join();
  ASSERT_FALSE(heard);
  EXPECT_THAT(heard.error().message, HasSubstr("Heard here: robot 'hero': is the name right?"));
}

TEST_F(RobotTest, TellsOtherDefinitions) {
  connect();
  event_t event{};
  ASSERT_TRUE(link_.publish("hero.v1.state", event));
  std::string message;
  while (message.find("other definitions") == std::string::npos) {
    const auto waited = robot_->waitForState(1ms);
    ASSERT_FALSE(waited);
    message = waited.error().message;
  }
  EXPECT_THAT(message, HasSubstr("hero.v1.state"));
}

TEST_F(RobotTest, NamesThatCannotBeAreRefusedInWords) {
  const Robot odd("he ro", link_, options());
  EXPECT_THAT(odd.status().error().message, HasSubstr("no robot's name"));
  EXPECT_FALSE(odd.motor("lift").brake());
  EXPECT_FALSE(odd.enable());
  auto wrong = options();
  wrong.resend = 1000ms;
  EXPECT_THAT(Robot("hero", link_, wrong).status().error().message, HasSubstr("shorter than validity"));
}

TEST(RobotWithoutLcm, SaysHowToGetIt) {
  const LcmLink none{"nonsense://"};
  EXPECT_THAT(none.status().error().message, HasSubstr("LCM could not start"));
  const Robot robot("hero", none);
  EXPECT_THAT(robot.waitForState().error().message, HasSubstr("LCM could not start"));
}

// ---- requests

TEST_F(RobotTest, AfterEnableTheStateShowsIt) {
  connect();
  ASSERT_TRUE(robot_->enable({"lift", "yaw"}));
  EXPECT_EQ(robot_->motor("lift").state().status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor("wheel").state().status, MotorStatus::kReady);
  EXPECT_THAT(rc10d_.operations(), ElementsAre("enable lift,yaw"));
}

TEST_F(RobotTest, ALostRequestIsRepeatedAndCarriedOutOnce) {
  rc10d_.deaf_to_requests = 2;
  connect();
  ASSERT_TRUE(robot_->request("clear", "", {}, kPatience));
  EXPECT_GE(rc10d_.asked.size(), 3U);
  EXPECT_EQ(rc10d_.asked[0].seq, rc10d_.asked[2].seq);
  EXPECT_THAT(rc10d_.operations(), ElementsAre("clear"));
}

TEST_F(RobotTest, AFailureHasAReasonForEachMotor) {
  rc10d_.verdicts["enable"] = {+response_t::STATUS_FAILED,
                               "enable: 1 of 3 motors (lift, yaw: offline: no power)"};
  connect();
  see();
  const auto answer = robot_->enable();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kFailed);
  ASSERT_EQ(answer.error().motors.size(), 2U);
  EXPECT_EQ(answer.error().motors[1].motor, "yaw");
  EXPECT_EQ(answer.error().motors[1].reason, "offline: no power");
}

TEST_F(RobotTest, ARefusalCarriesTheDaemonsWords) {
  rc10d_.verdicts["zero"] = {+response_t::STATUS_REFUSED, "the robot is stopping"};
  connect();
  const auto answer = robot_->motor("lift").zero(90_deg);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kRefused);
  EXPECT_EQ(answer.error().message, "zero refused: the robot is stopping");
  ASSERT_EQ(rc10d_.asked.size(), 1U);
  EXPECT_EQ(rc10d_.asked[0].values[0].name, "angle_deg");
  EXPECT_EQ(rc10d_.asked[0].values[0].value, 90.0);
}

TEST_F(RobotTest, GainsAreToldAndSet) {
  connect();
  ASSERT_TRUE(robot_->motor("lift").gains(kPatience));
  ASSERT_TRUE(robot_->motor("lift").setGains({{"velocity.kp", 0.4}}, kPatience));
  EXPECT_THAT(rc10d_.operations(), ElementsAre("get_config lift", "set_gains lift"));
  EXPECT_EQ(rc10d_.asked.back().values[0].name, "velocity.kp");
  EXPECT_EQ(rc10d_.asked.back().values[0].value, 0.4);
}

TEST_F(RobotTest, NoAnswerSaysWhatToCheck) {
  rc10d_.deaf_to_requests = 1000;
  connect();
  const auto answer = robot_->disable({}, 5ms);
  rc10d_.deaf_to_requests = 0;
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kNoAnswer);
  EXPECT_THAT(answer.error().message, HasSubstr("is rc10d running"));
}

TEST_F(RobotTest, AMotorThatDoesNotExistIsNotAskedFor) {
  connect();
  see();
  EXPECT_EQ(robot_->enable({"lft"}).error().kind, Kind::kNotSent);
  EXPECT_EQ(robot_->enable({"lift,yaw"}).error().kind, Kind::kNotSent);
  EXPECT_EQ(robot_->enable({""}).error().kind, Kind::kNotSent);
  EXPECT_THAT(rc10d_.operations(), IsEmpty());
}

TEST_F(RobotTest, AnEstopIsRepeatedUntilTheStateShowsIt) {
  connect();
  see();
  rc10d_.shows_estop = false;
  std::thread later([&] {
    EXPECT_TRUE(rc10d_.awaitRequests(4));
    const std::lock_guard lock(rc10d_.mutex);
    rc10d_.robot_state = robot_state_t::STATE_ESTOP;
  });
  EXPECT_TRUE(robot_->estop(kPatience));
  later.join();
  EXPECT_THAT(rc10d_.operations(), ElementsAre("estop"));
}

TEST_F(RobotTest, AnEstopThatDoesNotShowSaysToUseTheHardware) {
  connect();
  see();
  rc10d_.shows_estop = false;
  const auto stopped = robot_->estop(5ms);
  ASSERT_FALSE(stopped);
  EXPECT_THAT(stopped.error().message, HasSubstr("hardware emergency stop"));
}

TEST_F(RobotTest, AnEstopInACallbackDoesNotWait) {
  connect();
  std::promise<bool> stopped;
  robot_->onState([&](const RobotState&) {
    robot_->onState(nullptr);
    stopped.set_value(robot_->estop().has_value());
  });
  rc10d_.publishState();
  EXPECT_TRUE(stopped.get_future().get());
  EXPECT_TRUE(rc10d_.awaitRequests(1));
}

// ---- moves

TEST_F(RobotTest, AMoveIsDoneWhenTheMotorIsThere) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("lift").total_angle_deg = 719.0;
  }
  see(200ms);
  see(100ms);
  see(100ms);
  const auto result = move.get();
  EXPECT_EQ(result.outcome, Outcome::kDone) << result.reason;
  EXPECT_EQ(result.angle_deg, 719.0);
}

TEST_F(RobotTest, AMoveThatCannotBeginHasFailedAtOnce) {
  connect();
  see();
  auto move = robot_->motor("lift").moveTo(720_deg);
  const auto result = move.get();
  EXPECT_EQ(result.outcome, Outcome::kFailed);
  EXPECT_EQ(result.reason, "lift is READY: enable it first");
}

TEST_F(RobotTest, AMoveTimesOut) {
  connectEnabled();
  const auto result = robot_->motor("lift").moveTo(720_deg, 2_deg, 10ms).get();
  EXPECT_EQ(result.outcome, Outcome::kTimeout) << result.reason;
}

TEST_F(RobotTest, AnotherTargetEndsAMove) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  ASSERT_TRUE(robot_->motor("lift").brake());
  const auto result = move.get();
  EXPECT_EQ(result.outcome, Outcome::kFailed);
  EXPECT_EQ(result.reason, "lift was given another target");
}

TEST_F(RobotTest, AFaultEndsAMove) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  {
    const std::lock_guard lock(rc10d_.mutex);
    fakeMotor("lift").status = motor_state_t::STATUS_FAULT;
    fakeMotor("lift").fault_text = "stalled";
  }
  see(500ms);
  EXPECT_THAT(move.get().reason, HasSubstr("in FAULT (stalled)"));
}

TEST_F(RobotTest, LeavingEndsAMove) {
  connectEnabled();
  auto move = robot_->motor("lift").moveTo(720_deg, 2_deg, kPatience);
  robot_.reset();
  EXPECT_THAT(move.get().reason, HasSubstr("let go of the robot"));
}

// ---- leaving

TEST_F(RobotTest, LeavingIsATimeoutAtOnce) {
  connect();
  ASSERT_TRUE(robot_->enable({"lift", "wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  ASSERT_TRUE(robot_->close());
  ASSERT_TRUE(rc10d_.awaitCommand([](const command_t& command) { return command.validity_ms == 1; }));
  const auto last = rc10d_.commands().back();
  ASSERT_EQ(last.setpoint_count, 1);
  EXPECT_EQ(last.setpoints[0].mode, +setpoint_t::MODE_VELOCITY)
      << "COAST would leave on_timeout nothing to do";
  EXPECT_EQ(last.setpoints[0].value, 60.0);
  EXPECT_THAT(rc10d_.operations(), Not(Contains(HasSubstr("disable"))));
}

TEST_F(RobotTest, LeavingEndsNoTargetThatIsNotHeldAnyMore) {
  connect();
  ASSERT_TRUE(robot_->enable({"wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(robot_->motor("wheel").coast());
  ASSERT_TRUE(rc10d_.awaitCommand(
      [](const command_t& command) { return command.setpoints[0].mode == +setpoint_t::MODE_COAST; }));
  const auto sent = rc10d_.commands().size();
  ASSERT_TRUE(robot_->close());
  EXPECT_EQ(rc10d_.commands().size(), sent);
}

TEST_F(RobotTest, LeavingMayDisableAndNothingElse) {
  auto leaving = options();
  leaving.at_end = AtEnd::kDisable;
  connect(leaving);
  ASSERT_TRUE(robot_->enable({"wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(robot_->close());
  EXPECT_THAT(rc10d_.operations(), Contains("disable wheel"));
  for (const auto& command : rc10d_.commands()) EXPECT_NE(command.setpoints[0].mode, +setpoint_t::MODE_COAST);
}

TEST_F(RobotTest, LeavingMayCoastAndDisable) {
  auto leaving = options();
  leaving.at_end = AtEnd::kCoast;
  connect(leaving);
  ASSERT_TRUE(robot_->enable({"lift", "wheel"}));
  ASSERT_TRUE(robot_->motor("wheel").setTargetRPM(60_rpm));
  ASSERT_TRUE(rc10d_.awaitCommands(1));
  ASSERT_TRUE(robot_->close());
  const auto last = rc10d_.commands().back();
  ASSERT_EQ(last.setpoint_count, 1);
  EXPECT_EQ(last.setpoints[0].motor, "wheel");
  EXPECT_EQ(last.setpoints[0].mode, +setpoint_t::MODE_COAST);
  EXPECT_THAT(rc10d_.operations(), Contains("disable lift,wheel"));
  EXPECT_FALSE(robot_->motor("wheel").setTargetRPM(60_rpm));
  EXPECT_EQ(rc10d_.commands().back().seq, last.seq);
}

TEST_F(RobotTest, LeavingDisablesNothingThatItHasNotEnabled) {
  connect();
  see();
  ASSERT_TRUE(robot_->close());
  EXPECT_THAT(rc10d_.operations(), IsEmpty());
}

}  // namespace
}  // namespace test::robot_test
}  // namespace robot_client
}  // namespace rc10
