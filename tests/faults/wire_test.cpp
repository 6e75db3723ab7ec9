#include "faults/wire.hpp"

#include <chrono>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::wire_test {
namespace {

std::unique_ptr<Wire> wireOf(const std::string& motor) {
  const auto outcome = parseRobotConfig(
      "robot: wires\nbuses:\n  - name: bus\n    type: sim\n    data_bitrate: 5000000\n    motors:\n      - "
      "{" +
          motor + "}\n",
      "wires.yaml");
  if (!outcome) throw std::runtime_error(outcome.errorText());
  return makeWire(outcome.config->buses.front().motors.front());
}

void say(Wire& wire, std::initializer_list<const char*> frames) {
  for (const char* const frame : frames) ASSERT_NE(wire.said(frameOf(frame)), 0U) << frame;
}

void hear(Wire& wire, std::initializer_list<const char*> frames) {
  MonotonicTime now{};
  for (const char* const text : frames) {
    auto frame = frameOf(text);
    frame.received = now += std::chrono::milliseconds{1};
    (void)wire.heard(frame);
  }
}

void refuses(Wire& wire, const char* frame) {
  EXPECT_THROW((void)wire.said(frameOf(frame)), Violation) << frame;
}

// ---- Watchdogs, modes and limits that are told before a drive is enabled

constexpr const char* kDamiao = "name: arm, model: DM4310, id: 1, master_id: 17, watchdog_ms: 100";

TEST(DamiaoWireTest, TheRegisterOfTheWatchdogHoldsThatOfTheFile) {
  const auto wire = wireOf(kDamiao);
  say(*wire, {"7FF#01005509D0070000"});  // 2000 steps of 50 us
  refuses(*wire, "7FF#0100550900000000");
  refuses(*wire, "7FF#01005509D1070000");
}

TEST(DamiaoWireTest, TheRegisterOfTheModeHoldsThatOfTheFile) {
  const auto wire = wireOf(kDamiao);
  say(*wire, {"7FF#0100550A01000000"});
  refuses(*wire, "7FF#0100550A02000000");
}

TEST(DamiaoWireTest, IsNotEnabledWithoutItsWatchdogAndItsMode) {
  const auto wire = wireOf(kDamiao);
  refuses(*wire, "001#FFFFFFFFFFFFFFFC");
  say(*wire, {"7FF#0100550A01000000"});
  refuses(*wire, "001#FFFFFFFFFFFFFFFC");
  say(*wire, {"7FF#01005509D0070000", "001#FFFFFFFFFFFFFFFC"});
}

constexpr const char* kRobstride = "name: knee, model: RS00, id: 20, current_limit_a: 5, watchdog_ms: 100";

TEST(RobstrideWireTest, TheParameterOfTheWatchdogHoldsThatOfTheFile) {
  const auto wire = wireOf(kRobstride);
  say(*wire, {"1200FD14#28700000D0070000"});  // 20 a millisecond
  refuses(*wire, "1200FD14#2870000000000000");
}

TEST(RobstrideWireTest, ItsTorqueLimitIsNotBeyondThatOfTheFile) {
  const auto wire = wireOf(kRobstride);       // 5 A of peak, 1.48 N·m for each of effective value: 5.23 N·m
  say(*wire, {"1200FD14#0B70000000000040"});  // 2 N·m
  refuses(*wire, "1200FD14#0B7000000000C040");  // 6 N·m
}

TEST(RobstrideWireTest, IsNotEnabledWithoutItsWatchdogAndItsTorqueLimit) {
  const auto wire = wireOf(kRobstride);
  say(*wire, {"1200FD14#0B70000000000040"});
  refuses(*wire, "0300FD14#0000000000000000");
  say(*wire, {"1200FD14#28700000D0070000", "0300FD14#0000000000000000"});
}

// ---- Places

constexpr const char* kPan = "name: pan, model: LK-MG5010E-i10, id: 5, encoder_bits: 16";

TEST(LktechWireTest, ItsAngleIsAPlaceOfAllTurns) {
  const auto wire = wireOf(kPan);
  // A quarter of a turn, and three whole ones: 1170 degrees, of its rotor ten times as many.
  hear(*wire, {"145#9C19000000000040", "145#9250DA1100000000"});
  say(*wire, {"145#A400E80360011200"});
  EXPECT_EQ(wire->told().law, Told::Law::kAngle);
  EXPECT_NEAR(wire->told().ahead_deg, 10.0, 0.01);
  // And 630 degrees back.
  hear(*wire, {"145#921063F6FFFFFFFF"});
  say(*wire, {"145#A400E803208AF6FF"});
  EXPECT_NEAR(wire->told().ahead_deg, 10.0, 0.01);
}

TEST(LktechWireTest, ItsAngleIsNotReadBeforeItsTurnsAreKnown) {
  const auto wire = wireOf(kPan);
  hear(*wire, {"145#9C19000000000040"});
  say(*wire, {"145#A400E80360011200"});
  EXPECT_FALSE(std::isfinite(wire->told().ahead_deg));
}

TEST(VescWireTest, ItsAngleIsTheShortestWayFromItsEncoder) {
  const auto wire = wireOf(
      "name: mast, model: VESC, id: 10, pole_pairs: 7, angle: encoder, position_divider: 2, gear_ratio: 10, "
      "direction: -1");
  hear(*wire, {"0000100A#0000000000001388"});  // 100 degrees
  say(*wire, {"0000040A#14DC9380"});           // 350: 110 back, of two for each turn of its rotor
  EXPECT_EQ(wire->told().law, Told::Law::kAngle);
  EXPECT_NEAR(wire->told().ahead_deg, 22.0, 0.01);
  refuses(*wire, "0000040A#16000000");
}

TEST(MoteusWireTest, ItsVelocityLeadsToAPointThatIsNotFarAhead) {
  const auto wire = wireOf(
      "name: calf, model: moteus, id: 1, motor_kv_rpm_per_v: 100, current_limit_a: 10, watchdog_ms: 100");
  hear(*wire, {"100#2E010000803F00000000"});  // at one turn
  auto frame = frameOf(CanId{0x8001, true},
                       "01000A0F200000A03F0000803F000000000D250000004005276400"
                       "0228F6EC");  // at 1.25, with a turn a second
  frame.fd = true;
  ASSERT_NE(wire->said(frame), 0U);
  EXPECT_EQ(wire->told().law, Told::Law::kVelocity);
  EXPECT_NEAR(wire->told().ahead_deg, 90.0, 0.01);
  EXPECT_GT(wire->told().most_ahead_deg, 180.0);
  EXPECT_LT(wire->told().most_ahead_deg, 185.0);
}

// ---- Commands of somebody else

struct Stranger {
  const char* motor;
  std::vector<const char*> commands;
  std::vector<const char*> others;  ///< Rest, questions and frames for somebody else.
};

TEST(WireTest, KnowsTheFramesThatCommandItsDriveOfEachFamily) {
  const std::vector<Stranger> strangers{
      {"name: left, model: M3508, id: 1",
       {"200#0000000000000100", "200#FFFF000000000000"},
       {"200#0000000000000000", "1FF#0100000000000000"}},
      {kDamiao,
       {"001#7FFF7FF000000800", "101#0000C03F00004040"},
       {"001#FFFFFFFFFFFFFFFD", "7FF#0100330900000000", "002#7FFF7FF000000800"}},
      {kRobstride,
       {"017FFF14#7FFF7FFF00000000", "1200FD14#0A70000000004040"},
       {"0400FD14#0000000000000000", "1100FD14#1C70000000000000", "017FFF15#7FFF7FFF00000000"}},
      {"name: toe, model: AK80-9, id: 32, current_limit_a: 8",
       {"00000120#000003E8", "00000320#000003E8"},
       {"00000120#00000000", "00000121#000003E8"}},
      {"name: ankle, model: AK80-9, id: 31, protocol: mit, current_limit_a: 6",
       {"01F#7FFF7FF0100007FF", "01F#7FFF7FF000000FFF"},
       {"01F#7FFF7FF0000007FF", "01F#FFFFFFFFFFFFFFFD"}},
      {"name: belt, model: ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 20, "
       "velocity_limit_rpm: 600",
       {"06D#0000803F00000000", "06C#0000803F00000000", "06E#0000803F"},
       {"06E#00000000", "067#01000000", "08D#0000803F00000000"}},
      {"name: shooter, model: VESC, id: 10, pole_pairs: 7",
       {"0000010A#000003E8", "0000030A#00000000"},
       {"0000010A#00000000", "0000080A#FE0032", "0000010B#000003E8"}},
      {"name: turntable, model: RMD-X8-20, id: 22",
       {"156#A100000064000000", "416#7FFF7FF000000800"},
       {"156#8000000000000000", "156#9C00000000000000", "157#A100000064000000"}},
  };
  for (const auto& stranger : strangers) {
    const auto wire = wireOf(stranger.motor);
    for (const char* const text : stranger.commands)
      EXPECT_TRUE(wire->steeredBy(frameOf(text))) << stranger.motor << ", " << text;
    for (const char* const text : stranger.others)
      EXPECT_FALSE(wire->steeredBy(frameOf(text))) << stranger.motor << ", " << text;
  }
}

TEST(WireTest, ACommandToAnLktechIsKnownOnceItsTemperatureTellsItFromAnAnswer) {
  const auto wire = wireOf(kPan);
  const auto command = frameOf("145#A200640010270000");
  EXPECT_FALSE(wire->steeredBy(command));
  hear(*wire, {"145#9C19000000000040"});
  EXPECT_TRUE(wire->steeredBy(command));
  EXPECT_FALSE(wire->steeredBy(frameOf("145#A219000000000040")));  // its answer
  EXPECT_FALSE(wire->steeredBy(frameOf("145#9200000000000000")));
}

TEST(WireTest, AQuestionToAMoteusIsNoCommand) {
  const auto wire = wireOf("name: calf, model: moteus, id: 1, motor_kv_rpm_per_v: 100, current_limit_a: 10");
  const CanId id{0x8001, true};
  EXPECT_TRUE(wire->steeredBy(frameOf(id, "01000A")));
  EXPECT_FALSE(wire->steeredBy(frameOf(id, "010000")));  // it stops
  EXPECT_FALSE(wire->steeredBy(frameOf(id, "1100")));
}

}  // namespace
}  // namespace rc10::test::wire_test
