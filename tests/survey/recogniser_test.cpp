#include "survey/recogniser.hpp"

#include <gmock/gmock.h>

#include "bus/frame_text.hpp"
#include "survey/bus_survey.hpp"
#include "survey/harmless_queries.hpp"

// Frames of public documents and captures: those of tests/golden and of the families' golden tests.

namespace rc10::survey::recogniser_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

CanFrame frame(const char* text) {
  const auto parsed = parseFrameText(text);
  EXPECT_TRUE(parsed) << text;
  return parsed.value_or(CanFrame{});
}

std::vector<DriveGuess> of(const char* text) { return recognise(frame(text)); }

DriveGuess drive(std::string_view kind, int id) { return {kind, id, true}; }

TEST(Recogniser, KnowsDjiFeedback) {
  EXPECT_THAT(of("203#1000F44806662D00"), Contains(drive("DJI M3508 or M2006", 3)));
  EXPECT_THAT(of("20B#0800007810002600"), ElementsAre(drive("DJI GM6020", 7)));
}

TEST(Recogniser, DjiIdsOverlap) {
  EXPECT_THAT(of("206#1FFF12C0FA240000"),
              UnorderedElementsAre(drive("DJI M3508 or M2006", 6), drive("DJI GM6020", 2)));
}

TEST(Recogniser, AnAngleBeyondTheEncoderIsNoDji) { EXPECT_THAT(of("203#2000F44806662D00"), IsEmpty()); }

TEST(Recogniser, KnowsCommandsOfAnotherController) {
  EXPECT_THAT(of("200#2000F00000004000"), ElementsAre(DriveGuess{"DJI M3508 or M2006", 0, false}));
  EXPECT_THAT(of("00000001#00002710"), ElementsAre(DriveGuess{"VESC", 1, false}))
      << frameText(frame("00000001#00002710"));
}

TEST(Recogniser, KnowsVescStatusAndItsAnswerToAPing) {
  EXPECT_THAT(of("00000968#0000271000640064"), ElementsAre(drive("VESC", 0x68)));
  EXPECT_THAT(of("000012FE#2A"), ElementsAre(drive("VESC", 0x2A)));
}

TEST(Recogniser, KnowsRobStrideAndCyberGear) {
  EXPECT_THAT(of("02807FFD#70B987C186650138"), ElementsAre(drive("RobStride or CyberGear", 0x7F)));
  EXPECT_THAT(of("020501FD#7FFF7FFF7FFF05AF"), ElementsAre(drive("RobStride or CyberGear", 1)));
}

TEST(Recogniser, TheSerialNumberOfARobStrideMayBeTheStatusOfAVesc) {
  EXPECT_THAT(of("00007FFE#0102030405060708"), ElementsAre(drive("RobStride or CyberGear", 0x7F)));
  EXPECT_THAT(of("000009FE#0102030405060708"),
              UnorderedElementsAre(drive("VESC", 0xFE), drive("RobStride or CyberGear", 9)));
}

TEST(Recogniser, KnowsCubeMars) {
  EXPECT_THAT(of("00002968#04D2FF0602372A00"), ElementsAre(drive("CubeMars (servo)", 0x68)));
  EXPECT_THAT(of("000#68851E7FF7FF4600"), Contains(drive("CubeMars (MIT)", 0x68)));
}

TEST(Recogniser, DamiaoAndCubeMarsMayLookTheSame) {
  EXPECT_THAT(of("000#017FFF7FF7FF1E1E"),
              UnorderedElementsAre(drive("Damiao", 1), drive("CubeMars (MIT)", 1)));
  EXPECT_THAT(of("011#117FFF7FF7FF1E1E"),
              UnorderedElementsAre(drive("Damiao", 1), drive("CubeMars (MIT)", 0x11)));
  EXPECT_THAT(of("012#127FFF7FF7FF1E1E"), Contains(drive("Damiao", 2)));
}

TEST(Recogniser, KnowsMoteusOnFdOnly) {
  // Three registers as int16 in one answer: mode, position, velocity.
  EXPECT_THAT(of("100##12700000000000000"), ElementsAre(drive("moteus", 1)));
  EXPECT_THAT(of("100#2700000000000000"), ::testing::Not(Contains(drive("moteus", 1))));
}

TEST(Recogniser, KnowsOdrive) {
  EXPECT_THAT(of("061#4000000001010001"), ElementsAre(drive("ODrive", 3)));
  EXPECT_THAT(of("069#000000BE00006040"), Contains(drive("ODrive", 3)));
  EXPECT_THAT(of("077#CDCCC0410000C03F"), Contains(drive("ODrive", 3)));  // 24.1 V, 1.5 A
  EXPECT_THAT(of("075#0000F0410000C07F"), Contains(drive("ODrive", 3)));  // 30 degC, a motor without a sensor
  EXPECT_THAT(of("07C#0000003F0000803E"), Contains(drive("ODrive", 3)));  // 0.5 and 0.25 N·m
  EXPECT_THAT(of("074#0000803F0000803F"), Contains(drive("ODrive", 3)));
  EXPECT_THAT(of("077#0000000000000000"),
              Not(Contains(drive("ODrive", 3))));  // a drive that speaks has power
}

TEST(Recogniser, ANodeOfOdriveMayLookLikeADji) {
  EXPECT_THAT(of("201#0000000001000000"),
              UnorderedElementsAre(drive("DJI M3508 or M2006", 1), drive("ODrive", 16)));
}

TEST(Recogniser, KnowsLKTech) {
  EXPECT_THAT(of("141#A128F80098FE00C0"), Contains(drive("LK-Tech", 1)));
  EXPECT_THAT(of("141#9A1EC01264001008"), Contains(drive("LK-Tech", 1)));
  // A command, to either of the two; by its bytes the heartbeat of ODrive's node 10 too.
  EXPECT_THAT(of("141#A10000000CFE0000"),
              AllOf(Contains(DriveGuess{"LK-Tech", 1, false}), Contains(DriveGuess{"MyActuator", 1, false})));
}

TEST(Recogniser, KnowsMyActuator) {
  EXPECT_THAT(of("241#9A320001E5010400"), Contains(drive("MyActuator", 1)));
  EXPECT_THAT(of("501#01E66682EB550000"), Contains(drive("MyActuator", 1)));
}

TEST(Recogniser, KnowsEachStatusOfADamiao) {
  for (const char* text :
       {"011#017FFF7FF7FF1E1E", "011#117FFF7FF7FF1E1E", "011#217FFF7FF7FF1E1E", "011#317FFF7FF7FF1E1E",
        "011#417FFF7FF7FF1E1E", "011#517FFF7FF7FF1E1E", "011#817FFF7FF7FF1E1E", "011#E17FFF7FF7FF1E1E"})
    EXPECT_THAT(of(text), Contains(drive("Damiao", 1))) << text;
}

// Answers of the protocols' documents to any question, beside those that rc10d asks.
TEST(BusSurvey, NoAnswerToAnotherControllerHidesAMyActuator) {
  BusSurvey survey;
  for (const char* code :
       {"9A", "94", "90", "9D", "60", "61", "62", "63", "64", "42", "43", "B2", "B3", "B5",
        "B6", "30", "31", "32", "20", "70", "71", "77", "78", "80", "81", "A6", "A8", "F1"}) {
    survey.take(frame((std::string{"241#"} + code + "320001E5010400").c_str()));
    ASSERT_THAT(survey.sightings()[0].guesses, Contains(drive("MyActuator", 1))) << code;
  }
}

TEST(BusSurvey, NoAnswerToAnotherControllerHidesAnLKTech) {
  BusSurvey survey;
  for (const char* text :
       {"141#9A1EC01264001008", "141#8000000000000000", "141#8100000000000000", "141#8800000000000000",
        "141#8C00000000000000", "141#9000127856341200", "141#9D1E100020003000", "141#A01E100020003000",
        "141#A31E100020003000", "141#A51E100020003000", "141#A71E100020003000", "141#A81E100020003000"}) {
    survey.take(frame(text));
    ASSERT_THAT(survey.sightings()[0].guesses, Contains(drive("LK-Tech", 1))) << text;
  }
}

TEST(Recogniser, ErrorFramesAndRemoteFramesAreNoDrives) {
  auto error = frame("203#1000F44806662D00");
  error.type = FrameType::kError;
  EXPECT_THAT(recognise(error), IsEmpty());
}

TEST(BusSurvey, WhatFitsEveryFrameRemains) {
  BusSurvey survey;
  survey.take(frame("201#0000000001000000"));  // a DJI, or ODrive's node 16
  ASSERT_EQ(survey.sightings().size(), 1U);
  EXPECT_TRUE(survey.sightings()[0].ambiguous());
  survey.take(frame("201#1000F448F666FF00"));  // no state of an ODrive
  const auto sightings = survey.sightings();
  EXPECT_FALSE(sightings[0].ambiguous());
  EXPECT_THAT(sightings[0].guesses, ElementsAre(drive("DJI M3508 or M2006", 1)));
  EXPECT_EQ(sightings[0].frames, 2U);
}

TEST(BusSurvey, AHeartbeatDoesNotComeAThousandTimesASecond) {
  BusSurvey survey;
  for (int i = 0; i < 1000; ++i) survey.take(frame("201#0000000000000000"));
  EXPECT_TRUE(survey.sightings()[0].ambiguous());
  EXPECT_THAT(survey.sightings(std::chrono::seconds{1})[0].guesses,
              ElementsAre(drive("DJI M3508 or M2006", 1)));
  EXPECT_TRUE(survey.sightings(std::chrono::seconds{100})[0].ambiguous());
}

TEST(BusSurvey, DrivesThatShareAnIdAreSeveralOfOneKind) {
  BusSurvey survey;
  survey.take(frame("020#017FFF7FF7FF1E1E"));
  survey.take(frame("020#027FFF7FF7FF1E1E"));
  ASSERT_EQ(survey.sightings().size(), 1U);
  EXPECT_FALSE(survey.sightings()[0].ambiguous());
  EXPECT_THAT(survey.sightings()[0].guesses, UnorderedElementsAre(drive("Damiao", 1), drive("Damiao", 2)));
}

TEST(BusSurvey, AStrangersFrameIsKeptAsUnknown) {
  BusSurvey survey;
  survey.take(frame("7FE#01"));
  ASSERT_EQ(survey.sightings().size(), 1U);
  EXPECT_THAT(survey.sightings()[0].guesses, IsEmpty());
  EXPECT_FALSE(survey.sightings()[0].ambiguous());
}

// A standard id means something else to each family; and below 6 a VESC and a CubeMars drive take the third
// byte for a command that gives torque, 8 is CubeMars' MIT.
TEST(Recogniser, KnowsTheHeartbeatOfAnOdriveWithExtendedIds) {
  EXPECT_THAT(of("00000061#0000000001000100"), Contains(drive("ODrive (extended ids)", 3)));
  EXPECT_THAT(of("00000069#000000BE00006040"), IsEmpty())
      << "not its encoder: any two numbers look like that";
}

TEST(Recogniser, AVescAtRestIsNoOdrive) {
  EXPECT_THAT(of("00000901#0000000000000000"), ElementsAre(drive("VESC", 1)));
}

TEST(BusSurvey, AHeartbeatUnderTheIdOfAVescIsAmbiguous) {
  BusSurvey survey;
  survey.take(frame("00000901#0000000008000000"));
  const auto sightings = survey.sightings();
  ASSERT_EQ(sightings.size(), 1U);
  EXPECT_TRUE(sightings[0].ambiguous());
  EXPECT_THAT(sightings[0].guesses,
              UnorderedElementsAre(drive("VESC", 1), drive("ODrive (extended ids)", 72)));
}

TEST(BusSurvey, AQueryThatAnOdriveWouldObeyIsKnown) {
  BusSurvey survey;
  const auto spared = [&survey] {
    std::vector<std::uint32_t> ids;
    for (const auto& query : harmlessQueries())
      if (!survey.commandedBy(query).empty()) ids.push_back(query.id.value);
    return ids;
  };
  EXPECT_THAT(spared(), IsEmpty());
  survey.take(frame("00001101#0000000001000000"));  // node 136, where the PING of VESC 2 is the e-stop
  EXPECT_EQ(spared().size(), 32U);
  EXPECT_EQ(spared().front(), 0x1100U);
  EXPECT_EQ(survey.commandedBy(frame("00001102#FE")), "an ODrive with extended ids, node 136");
  survey.take(frame("0000FD01#0000000008000000"));  // node 2024, which would be told a position of zero
  EXPECT_EQ(survey.commandedBy(frame("0000FD0C#0000000000000000")), "an ODrive with extended ids, node 2024");
  EXPECT_EQ(spared().size(), 32U + 31U);
}

TEST(BusSurvey, NoRobstrideIsAskedBesideADriveThatItsAnswerWouldCommand) {
  const auto question = frame("0000FD01#0000000000000000");
  BusSurvey survey;
  survey.take(frame("0000092A#0000271000640064"));
  survey.take(frame("000001FE#0102030405060708"));  // the answer itself, as of a drive that is switched on
  EXPECT_EQ(survey.commandedBy(question), "");
  survey.take(frame("000009FE#0000271000640064"));
  EXPECT_EQ(survey.commandedBy(question), "VESC 254, by an answer");
  EXPECT_EQ(survey.commandedBy(frame("000011FD#FE")), "");
}

TEST(HarmlessQueries, AreExtendedFramesThatCommandNobody) {
  for (const auto& query : harmlessQueries()) {
    EXPECT_TRUE(query.id.extended);
    EXPECT_FALSE(query.fd);
    EXPECT_THAT((query.id.value >> 8U), ::testing::AnyOf(0x11U, 0xFDU)) << frameText(query);
  }
  EXPECT_EQ(harmlessQueries().size(), 254U + 127U);
}

}  // namespace
}  // namespace rc10::survey::recogniser_test
