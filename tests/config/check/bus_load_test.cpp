#include "config/check/bus_load.hpp"

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::bus_load_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// `count` M3508 of ids 1, 2, ...; the bus stands in line 3, column 5.
std::string robotWithWheels(int count, const std::string& head = "", const std::string& keys = "",
                            const std::string& type = "type: sim") {
  std::string text = head + "robot: hero\nbuses:\n  - name: chassis\n    " + type + "\n    motors:\n";
  for (int id = 1; id <= count; ++id) {
    const auto number = std::to_string(id);
    text += "      - {name: m" + number + ", model: M3508, id: " + number + keys + "}\n";
  }
  return text;
}

BusConfig wheels(int count, const std::string& keys = "") {
  BusConfig bus;
  for (int id = 1; id <= count; ++id) {
    bus.motors.push_back(motorOf("{name: a, model: M3508, id: " + std::to_string(id) + keys + "}"));
  }
  return bus;
}

TEST(BusLoad, IsThatOfTheProtocolReference) {  // docs: frame lengths 111 and 135 bits
  EXPECT_DOUBLE_EQ(predictLoad(wheels(4), 1000).unstuffed, 0.555);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(4), 1000).worst_case, 0.675);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(6), 1000).unstuffed, 0.888);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(6), 1000).worst_case, 1.08);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(8), 1000).unstuffed, 1.11);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(8), 1000).worst_case, 1.35);
}

TEST(BusLoad, GrowsWithTheRatesOfBothDirections) {
  EXPECT_DOUBLE_EQ(predictLoad(wheels(4), 2000).unstuffed, 0.666);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(4), 500).unstuffed, 0.4995);
  EXPECT_DOUBLE_EQ(predictLoad(wheels(4, ", feedback_hz: 500"), 1000).unstuffed, 0.333);
}

TEST(BusLoad, CountsOneCommandFrameForEachIdInUse) {
  BusConfig bus;
  bus.motors.push_back(motorOf("{name: a, model: M3508, id: 1}"));                     // 0x200
  bus.motors.push_back(motorOf("{name: b, model: M2006, id: 5}"));                     // 0x1FF
  bus.motors.push_back(motorOf("{name: c, model: GM6020, id: 5}"));                    // 0x2FE
  bus.motors.push_back(motorOf("{name: d, model: GM6020, id: 6, command: voltage}"));  // 0x2FF
  EXPECT_DOUBLE_EQ(predictLoad(bus, 1000).unstuffed, 8 * 0.111);
}

TEST(BusLoad, KnowsTheFeedbackRateThatFits) {
  // 0.8 Mbit/s / 135 bits = 5925 frames, 2000 of them commands, 8 motors.
  EXPECT_EQ(feedbackRateThatFits(wheels(8), 1000), 490);
  const auto at_that_rate = predictLoad(wheels(8, ", feedback_hz: 490"), 1000);
  EXPECT_LE(at_that_rate.worst_case, kCrowdedLoad);
  EXPECT_GT(predictLoad(wheels(8, ", feedback_hz: 491"), 1000).worst_case, kCrowdedLoad);
  EXPECT_EQ(feedbackRateThatFits(wheels(8), 4000), 0);
  EXPECT_EQ(feedbackRateThatFits(BusConfig{}, 1000), 0);
}

TEST(BusLoad, BeyondTheBusIsAnErrorWithTheRateThatFits) {
  EXPECT_THAT(
      errorsOf(robotWithWheels(8)),
      ElementsAre(
          "hero.yaml:3:5: buses[0]: predicted load 111 % to 135 % (no stuff bits, all stuff bits) of "
          "1000000 bit/s does not fit; feedback at 490 Hz or less (set on the drives, then feedback_hz) "
          "keeps it within 80 %; or move motors to another bus"));
  EXPECT_THAT(errorsOf(robotWithWheels(8, "", ", feedback_hz: 490")), IsEmpty());
}

TEST(BusLoad, IsTheSameForASocketCanBus) {
  EXPECT_EQ(errorsOf(robotWithWheels(8)), errorsOf(robotWithWheels(8, "", "", "interface: can0")));
}

TEST(BusLoad, ThatCrowdsTheBusIsAWarning) {
  const auto text = robotWithWheels(7);
  EXPECT_THAT(errorsOf(text), IsEmpty());
  EXPECT_THAT(
      warningsOf(text),
      ElementsAre(
          "hero.yaml:3:5: buses[0]: predicted load 99.9 % to 121.5 % (no stuff bits, all stuff bits) of "
          "1000000 bit/s makes frames wait; feedback at 560 Hz or less (set on the drives, then "
          "feedback_hz) keeps it within 80 %; or move motors to another bus"));
  EXPECT_THAT(warningsOf(robotWithWheels(4)), IsEmpty());
}

TEST(BusLoad, OfCommandsAloneIsMendedByTheirRate) {
  EXPECT_THAT(
      errorsOf(robotWithWheels(8, "scheduler: {rate_hz: 4000}\n")),
      ElementsAre(
          "hero.yaml:4:5: buses[0]: predicted load 177.6 % to 216 % (no stuff bits, all stuff bits) of "
          "1000000 bit/s does not fit; no feedback rate fits at scheduler.rate_hz 4000: move motors to "
          "another bus, or lower rate_hz"));
}

}  // namespace
}  // namespace rc10::test::bus_load_test
