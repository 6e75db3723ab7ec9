#include "client/state_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "client/module_text.hpp"
#include "fake_rc10d.hpp"
#include "link/words.hpp"
#include "sample_messages.hpp"

namespace rc10::client::test::state_text_test {
namespace {

using rc10::test::heroDiagnostics;
using rc10::test::heroState;
using rc10::test::heroWelcome;
using testing::HasSubstr;
using testing::Not;

TEST(ListText, NamesEveryMotor) {
  EXPECT_EQ(listText(heroWelcome()),
            "robot hero  rc10d 0.1.0, pid 4321, 1000 Hz\n"
            "LCM udpm://239.255.76.67:7667?ttl=0, state 200 Hz\n"
            "MOTOR       MODEL   BUS      ID  MODES\n"
            "front_left  M3508   chassis   1  current,velocity\n"
            "yaw         GM6020  gimbal    5  current,angle,total_angle\n");
}

TEST(ListText, IsSilentAboutAnLcmThatIsOff) {
  auto welcome = heroWelcome();
  welcome.lcm_url = "";
  EXPECT_THAT(listText(welcome), Not(HasSubstr("LCM")));
}

TEST(StateText, ColoursSayWhatActsAndWhatIsWrong) {
  const std::string text = stateText(heroWelcome(), heroState(), nullptr, true);
  EXPECT_THAT(text, HasSubstr("\x1b[33mfront_left"));  // a limit acts
  EXPECT_THAT(text, HasSubstr("\x1b[1;31myaw"));
  EXPECT_THAT(text, HasSubstr("\x1b[0m\n"));
}

TEST(StateText, ShowsEveryMotorWithUnits) {
  const auto diagnostics = heroDiagnostics();
  EXPECT_EQ(stateText(heroWelcome(), heroState(), &diagnostics),
            "hero  RUN  tick 41000  wake-up p99 38 us, max 180 us  missed ticks 2\n"
            "bus chassis (can0)  warning  load 55 % of predicted 56 %  dropped 5  error frames 7\n"
            "MOTOR       STATUS  MODE         TARGET   MEASURED      ANGLE  CURRENT  TEMP     AGE  ZEROED  "
            "OWNER   NOTE\n"
            "front_left  ACTIVE  velocity  120.0 rpm  118.3 rpm  121.5 deg   0.42 A  31 C  0.4 ms  no      "
            "teleop  limit: current\n"
            "yaw         FAULT   coast             -          -          -        -     -       -  yes       "
            "      fault 12\n");
}

TEST(StateText, ShowsWhatActsOnAMotorThatNobodyCommandsAndWhoStoppedIt) {
  auto state = heroState();
  auto& wheel = state.motors[0];
  wheel.status = MotorStatus::kReady;
  wheel.mode = ControlMode::kCoast;
  wheel.acting = Acting::kHold;
  wheel.limits = 0;
  wheel.stop_cause = StopCause::kRequest;
  wheel.stopped_by = "teleop";
  const std::string text = stateText(heroWelcome(), state, nullptr);
  EXPECT_THAT(text, testing::ContainsRegex("front_left  READY   hold  .*asked for by 'teleop'\n"));
}

TEST(StateText, SaysWhoStoppedTheRobotAndThatItIsSimulated) {
  auto state = heroState();
  state.robot_state = RobotStatus::kEstop;
  state.stop_cause = StopCause::kRequest;
  state.stopped_by = "\x1b[31mjudge";
  state.conditions = kConditionSimulated | kConditionInputOpen;
  const std::string text = stateText(heroWelcome(), state, nullptr);
  EXPECT_THAT(text, HasSubstr("ESTOP (asked for by '"));
  EXPECT_THAT(text, HasSubstr("  SIMULATED  E-STOP INPUT OPEN  tick"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(StateText, SaysThatSpeedAndCurrentAreReduced) {
  auto state = heroState();
  state.conditions = kConditionReduced;
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr), HasSubstr("  REDUCED SPEED  tick"));
}

TEST(StateText, SaysThatTuningIsLocked) {
  auto state = heroState();
  state.conditions = kConditionTuningLocked;
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr), HasSubstr("  TUNING LOCKED  tick"));
  EXPECT_EQ(link::conditionWords(kConditionTuningLocked), "tuning-locked");
}

TEST(StateText, DoesWithoutDiagnostics) {
  auto state = heroState();
  state.robot_state = RobotStatus::kEstop;
  state.realtime = 0;
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr),
              HasSubstr("hero  ESTOP  NOT REAL-TIME  tick 41000\nMOTOR"));
}

TEST(StateText, ShowsOnlyMotorsThatHaveAName) {
  auto state = heroState();
  state.motor_count = 100;
  const std::string text = stateText(heroWelcome(), state, nullptr);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
}

TEST(StateText, IsSafeForATerminal) {
  auto state = heroState();
  state.motors[0].owner = "\x1b]0;gotcha\x07";
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr), Not(HasSubstr("\x1b")));
}

TEST(Measured, IsTheCounterpartOfTheTarget) {
  const auto motor = heroState().motors[0];
  EXPECT_FLOAT_EQ(static_cast<float>(measured(motor, ControlMode::kCurrent)), 0.42F);
  EXPECT_FLOAT_EQ(static_cast<float>(measured(motor, ControlMode::kVelocity)), 118.26F);
  EXPECT_FLOAT_EQ(static_cast<float>(measured(motor, ControlMode::kAngle)), 121.5F);
  EXPECT_EQ(measured(motor, ControlMode::kTotalAngle), 7321.5);
  EXPECT_FLOAT_EQ(static_cast<float>(measured(motor, ControlMode::kImpedance)), 121.5F);
  EXPECT_FLOAT_EQ(static_cast<float>(measured(motor, ControlMode::kCoast)), 118.26F);
  EXPECT_STREQ(measuredUnit(ControlMode::kCurrent), "A");
  EXPECT_STREQ(measuredUnit(ControlMode::kDuty), "rpm");
  EXPECT_STREQ(measuredUnit(ControlMode::kImpedance), "deg");
}

TEST(DiagnosticsText, ShowsTimingBusesAndRefusals) {
  EXPECT_EQ(diagnosticsText(heroWelcome(), heroDiagnostics()),
            "robot hero  tick 41001, one every 1000 us\n"
            "TIME                    P50       P99     P99.9        MAX\n"
            "wake-up latency      4.1 us   38.5 us   61.0 us   180.2 us\n"
            "tick duration       12.0 us   19.5 us   25.0 us    70.0 us\n"
            "command to frames  420.0 us  900.0 us  950.0 us  1020.5 us\n"
            "missed ticks 2, page faults 0, events dropped 1\n"
            "BUS                chassis\n"
            "interface             can0\n"
            "state              warning\n"
            "load                  55 %\n"
            "  predicted           56 %\n"
            "  predicted worst     68 %\n"
            "frames received     164000\n"
            "  of no motor            5\n"
            "  foreign sender         6\n"
            "  malformed              1\n"
            "  lost                   2\n"
            "frames sent          41000\n"
            "  echoed             40990\n"
            "  not taken              3\n"
            "  held back              8\n"
            "error frames             7\n"
            "  TEC, REC           96, -\n"
            "restarts                 4\n"
            "refused commands: expired 3\n"
            "note: not real-time: no permission\n");
}

TEST(DiagnosticsText, SaysWhyTicksWereLateAndWhatHelps) {
  auto diagnostics = heroDiagnostics();
  diagnostics.counter_count = 3;
  diagnostics.counters[0] = {.name = link::Text<48>{"late ticks: CPU taken"}, .count = 7};
  diagnostics.counters[1] = {.name = link::Text<48>{"late ticks: timer"}, .count = 0};
  diagnostics.counters[2] = {.name = link::Text<48>{"late ticks: CPU taken by irq/57-spi0.0"}, .count = 3};
  const auto text = diagnosticsText(heroWelcome(), diagnostics);
  EXPECT_THAT(text, HasSubstr("late ticks: CPU taken 7 (others ran on its CPU"));
  EXPECT_THAT(text,
              HasSubstr("late ticks: CPU taken by irq/57-spi0.0 3 (a real-time thread of rc10d's priority"));
  EXPECT_THAT(text, Not(HasSubstr("timer")));
}

TEST(DiagnosticsText, SaysThatNothingWasRefused) {
  auto diagnostics = heroDiagnostics();
  diagnostics.refusal_count = 0;
  diagnostics.bus_count = 0;
  EXPECT_THAT(diagnosticsText(heroWelcome(), diagnostics), HasSubstr("refused commands: none\n"));
}

TEST(StateText, AnAngleIsShownBesideItsTarget) {
  auto state = heroState();
  auto& wheel = state.motors[0];
  wheel.mode = ControlMode::kAngle;
  wheel.target = -15.3;
  wheel.angle_deg = 346.7F;
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr), HasSubstr("-15.3 deg  -13.3 deg  -13.3 deg"));
  wheel.target = 370.0;
  wheel.angle_deg = 9.0F;
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr), HasSubstr("370.0 deg  369.0 deg  9.0 deg"));
  wheel.mode = ControlMode::kCoast;
  wheel.angle_deg = 359.99F;
  EXPECT_THAT(stateText(heroWelcome(), state, nullptr), HasSubstr("  0.0 deg"));
}

TEST(ModuleLines, TellWhoCommandsThemAndWhatTheyGive) {
  ModuleView base{link::Name{"base"}, {}, {}};
  base.info.type = "mecanum_chassis";
  base.info.input_count = 1;
  base.info.output_count = 1;
  base.info.names[0] = "vx_m_s";
  base.info.names[1] = "x_m";
  base.state.values[0] = 0.5;
  ModuleView buttons{link::Name{"buttons"}, {}, {}};
  buttons.info.type = "gpio";
  buttons.info.output_count = 1;
  buttons.info.names[0] = "start";
  buttons.state.values[0] = 1.0;
  auto driven = base;
  driven.state.owner = "\x1b[31mremote";
  EXPECT_EQ(
      moduleLines({base, buttons}),
      "module base (mecanum_chassis)  commanded by nobody  x_m 0.50\nmodule buttons (gpio)  start 1.00\n");
  EXPECT_EQ(moduleLines({driven}), "module base (mecanum_chassis)  commanded by '?[31mremote'  x_m 0.50\n");
}

TEST(ModuleLines, LeaveOutMouseAndKeysOfARemoteThatNobodyTouches) {
  ModuleView remote{link::Name{"remote"}, {}, {}};
  remote.info.type = "remote";
  remote.info.output_count = 4;
  remote.info.names[0] = "connected";
  remote.info.names[1] = "mouse_x";
  remote.info.names[2] = "key_w";
  remote.info.names[3] = "key_s";
  remote.state.values[0] = 1.0;
  remote.state.values[1] = std::numeric_limits<double>::quiet_NaN();
  remote.state.values[2] = 1.0;
  EXPECT_EQ(moduleLines({remote}), "module remote (remote)  connected 1.00  key_w 1.00\n");
}

}  // namespace
}  // namespace rc10::client::test::state_text_test
