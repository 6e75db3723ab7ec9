#include "rc10/robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_rig.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::robot_test {
namespace {

using namespace std::chrono_literals;
using namespace rc10::literals;
using testing::HasSubstr;
using testing::IsEmpty;

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

}  // namespace
}  // namespace test::robot_test
}  // namespace robot_client
}  // namespace rc10
