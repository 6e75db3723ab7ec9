// Records of the scheduler in each tick.

#include "daemon/recording/flight_recorder.hpp"

#include <gmock/gmock.h>

#include <map>

#include "blackbox/memory_box.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/virtual_robot.hpp"
#include "link/event_text.hpp"

namespace rc10::test::flight_recorder_test {
namespace {

using namespace std::chrono_literals;

constexpr Target kSixtyRpm{.mode = ControlMode::kVelocity, .value = 60.0};

std::string textOf(const blackbox::Event& event) {
  return link::eventText(static_cast<std::int32_t>(event.header.id), event.value, event.extra,
                         event.client.view());
}

class FlightRecorderTest : public ::testing::Test {
 protected:
  template <typename T>
  std::vector<T> recorded() {
    return all<T>(box.recording());
  }
  std::vector<std::string> eventTexts() {
    std::vector<std::string> texts;
    for (const auto& event : recorded<blackbox::Event>()) texts.push_back(textOf(event));
    return texts;
  }

  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  VirtualRobot robot{twoWheelsAndYaw(), &recorder};
};

TEST_F(FlightRecorderTest, EveryFrameIsThereWithItsDirection) {
  robot.run(20);
  const auto& counters = robot.robot().buses()[0].bus->counters();
  std::uint64_t received = 0;
  std::uint64_t sent = 0;
  for (const auto& frame : recorded<blackbox::Frame>()) {
    EXPECT_EQ(frame.header.source, 0);
    ++((frame.header.flags & blackbox::kFrameSent) != 0 ? sent : received);
  }
  EXPECT_EQ(received, counters.rx_frames);
  EXPECT_EQ(sent, counters.tx_frames);
  EXPECT_GE(received, 50U);
  EXPECT_GE(sent, 20U);
}

TEST_F(FlightRecorderTest, AFrameIsTheSameByteForByte) {
  CanFrame frame = makeFdFrame({0x1234567, true}, std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}, true);
  frame.received = MonotonicTime{5s};
  robot.robot().buses()[0].bus->dispatch(frame);
  const auto recorded_frame = recorded<blackbox::Frame>().back();
  EXPECT_EQ(recorded_frame.header.id, 0x1234567U | blackbox::kIdExtended);
  EXPECT_EQ(recorded_frame.header.time_ns, 5'000'000'000);
  EXPECT_EQ(recorded_frame.header.flags, blackbox::kFrameFd | blackbox::kFrameBitRateSwitch | 9);
  EXPECT_EQ(blackbox::payloadBytes(recorded_frame.header.flags), 12U);
  EXPECT_TRUE(std::equal(frame.data.begin(), frame.data.begin() + 12, recorded_frame.data.begin()));
}

TEST_F(FlightRecorderTest, ACommandThatAdmissionRefusedIsAnEvent) {
  Event refusal{EventCode::kCommandRefused,
                Severity::kWarning,
                -1,
                static_cast<std::int32_t>(CommandRefusal::kNotFinite),
                0,
                robot.now()};
  refusal.client = "planner";
  ASSERT_TRUE(robot.exchange().refusals.push(refusal));
  robot.tick();
  EXPECT_THAT(eventTexts(), testing::Contains("command of 'planner' refused: not finite"));
  EXPECT_TRUE(robot.events().empty()) << "clients have been told before";
}

TEST_F(FlightRecorderTest, AFrameThatTheKernelRefusedIsMarked) {
  robot.freezeSimulation(true);  // nobody reads: in the end there is no room
  auto& bus = *robot.robot().buses()[0].bus;
  for (int i = 0; i < 10'000 && bus.counters().tx_dropped == 0; ++i) robot.tick();
  ASSERT_GT(bus.counters().tx_dropped, 0U);
  const auto last = recorded<blackbox::Frame>().back();
  EXPECT_EQ(last.header.flags & (blackbox::kFrameSent | blackbox::kFrameRefused),
            blackbox::kFrameSent | blackbox::kFrameRefused);
}

TEST_F(FlightRecorderTest, ACommandIsThereWithItsSetpointsAndWhatBecameOfIt) {
  robot.run(5);
  robot.order(Operation::kEnable);
  robot.commandAs("planner", 3, 1, kSixtyRpm);
  robot.tick();
  robot.commandAs("other", 3, 1, kSixtyRpm);
  robot.tick();
  robot.command(0, kSixtyRpm, -1ms);
  robot.tick();

  const auto commands = recorded<blackbox::Command>();
  ASSERT_EQ(commands.size(), 3U);
  EXPECT_EQ(commands[0].client.view(), "planner");
  EXPECT_EQ(commands[0].priority, 3);
  EXPECT_EQ(commands[0].header.id, 1U);
  EXPECT_EQ(commands[0].header.flags, static_cast<int>(blackbox::Verdict::kApplied));
  EXPECT_EQ(commands[1].header.flags, static_cast<int>(blackbox::Verdict::kNotOwner));
  EXPECT_EQ(commands[2].header.flags, static_cast<int>(blackbox::Verdict::kExpired));

  const auto setpoints = recorded<blackbox::Setpoint>();
  ASSERT_EQ(setpoints.size(), 3U);
  EXPECT_EQ(setpoints[0].header.source, 1);
  EXPECT_EQ(setpoints[0].header.id, static_cast<unsigned>(ControlMode::kVelocity));
  EXPECT_EQ(setpoints[0].value, 60.0);
  EXPECT_EQ(setpoints[0].header.flags, 0);
}

TEST_F(FlightRecorderTest, ASetpointThatDidNotActIsMarkedAndFeedForwardIsKept) {
  robot.run(5);
  Target target = kSixtyRpm;
  target.torque_ff_nm = 0.5F;
  robot.command(0, target);  // not enabled
  robot.tick();
  const auto setpoint = recorded<blackbox::Setpoint>().at(0);
  EXPECT_EQ(setpoint.header.flags, blackbox::kSetpointSkipped);
  EXPECT_EQ(setpoint.torque_ff_nm, 0.5F);
}

TEST_F(FlightRecorderTest, RequestsAreThereWithTheirMotors) {
  robot.run(5);
  robot.order(Operation::kEnable);
  const auto orders = recorded<blackbox::Order>();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].header.flags, static_cast<int>(Operation::kEnable));
  EXPECT_EQ(orders[0].motors[0], 0b111U);
}

TEST_F(FlightRecorderTest, EveryEventIsThere) {
  robot.run(5);
  robot.order(Operation::kEnable);
  robot.order(Operation::kEstop);
  EXPECT_EQ(recorded<blackbox::Event>().size(), robot.events().size());
  EXPECT_THAT(eventTexts(), ::testing::Contains("RUN -> ESTOP (asked for)"));
  EXPECT_THAT(eventTexts(), ::testing::Contains("ENABLING -> ACTIVE").Times(3));
}

TEST_F(FlightRecorderTest, StatesAreSampledTwentyTimesASecondAndWhenTheyChange) {
  robot.run(1000);
  // In the first tick and in twenty turns; every motor also when it became READY.
  EXPECT_EQ(recorded<blackbox::Motor>().size(), 3U * 22U);
  EXPECT_EQ(recorded<blackbox::Robot>().size(), 21U);
  EXPECT_EQ(recorded<blackbox::Bus>().size(), 21U);
  robot.order(Operation::kEnable);
  const auto last = recorded<blackbox::Motor>().back();
  EXPECT_EQ(last.header.flags, static_cast<int>(MotorStatus::kActive));
  EXPECT_EQ(last.header.time_ns, robot.now().time_since_epoch().count());
}

TEST_F(FlightRecorderTest, NoTickCarriesTheSamplesOfAll) {
  robot.run(200);  // every motor is READY, which it has told
  const auto settled_ns = robot.now().time_since_epoch().count();
  robot.run(1000);
  std::map<std::int64_t, int> samples;
  const auto count = [&](const auto& records) {
    for (const auto& record : records)
      if (record.header.time_ns > settled_ns) ++samples[record.header.time_ns];
  };
  count(recorded<blackbox::Motor>());
  count(recorded<blackbox::Robot>());
  count(recorded<blackbox::Bus>());
  EXPECT_EQ(samples.size(), 5U * 20U) << "three motors, a bus and the robot, each in a tick of its own";
  for (const auto& [time_ns, of_tick] : samples) EXPECT_EQ(of_tick, 1) << time_ns;
}

TEST_F(FlightRecorderTest, AnEstopIsACauseForACopyOnceEachTime) {
  robot.run(5);
  EXPECT_EQ(recorder.takeCauses(), 0U);
  robot.order(Operation::kEstop);
  EXPECT_EQ(recorder.takeCauses(), static_cast<std::uint32_t>(CopyCause::kEstop));
  robot.run(100);
  EXPECT_EQ(recorder.takeCauses(), 0U);
  robot.order(Operation::kClear);
  EXPECT_EQ(recorder.takeCauses(), 0U);
}

TEST(FlightRecorderFault, AFaultIsACauseForACopy) {
  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[0].guard.overspeed_rpm = 100.0F;
  VirtualRobot robot{config, &recorder};
  robot.run(5);
  robot.order(Operation::kEnable);
  robot.hold(0, {.mode = ControlMode::kVelocity, .value = 200.0}, 1500);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kFault);
  EXPECT_EQ(recorder.takeCauses(), static_cast<std::uint32_t>(CopyCause::kFault));
}

}  // namespace
}  // namespace rc10::test::flight_recorder_test
