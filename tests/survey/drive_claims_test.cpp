#include "survey/drive_claims.hpp"

#include <gmock/gmock.h>

#include "bus/frame_text.hpp"
#include "drives/families.hpp"
#include "survey/harmless_queries.hpp"
#include "survey/link_sighting.hpp"

namespace rc10::survey::drive_claims_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const MotorFamily* family(std::string_view name) {
  for (const auto& entry : builtInFamilies()) {
    if (entry.family->name() == name) return entry.family;
  }
  ADD_FAILURE() << name;
  return nullptr;
}

CanFrame frameOf(const char* text) { return parseFrameText(text).value_or(CanFrame{}); }

constexpr const char* kDji1 = "201#0123004520121900";
constexpr const char* kDji3 = "203#0123004520121900";
constexpr const char* kPong42 = "000012FE#2A";
constexpr const char* kStatusOf42 = "0000092A#0000271000640064";

KnownMotor wheel() { return {"wheel", family("DJI"), 1, {FrameFilter{.id = {0x201, false}}}, {}}; }
KnownMotor vesc() {
  return {"pump", family("VESC"), 42, {FrameFilter{.id = {0x92A, true}}}, {FrameFilter{.id = {0x12A, true}}}};
}

TEST(DriveClaims, ADriveOfTheFileIsItsMotors) {
  DriveClaims claims{{wheel()}};
  claims.take(frameOf(kDji1));
  claims.take(frameOf(kDji3));
  const auto claim = claims.of({"DJI M3508 or M2006", 1});
  ASSERT_TRUE(claim);
  EXPECT_EQ(claim->motor, 0U);
  EXPECT_FALSE(claim->collides);
  EXPECT_FALSE(claims.of({"DJI M3508 or M2006", 3})) << "is not in the file";
}

TEST(DriveClaims, OfTwoModelsThatShareAFrameIdItIsTheOneOfTheFile) {
  DriveClaims claims{{{"yaw", family("DJI"), 1, {FrameFilter{.id = {0x205, false}}}, {}}}};
  claims.take(frameOf("205#0000000000190000"));
  EXPECT_TRUE(claims.of({"DJI GM6020", 1}));
  EXPECT_FALSE(claims.of({"DJI M3508 or M2006", 5}));
}

TEST(DriveClaims, AMotorOfWhichNothingIsHeardIsNamed) {
  DriveClaims claims{{wheel(), vesc()}};
  EXPECT_THAT(claims.unheard(), ElementsAre("wheel", "pump"));
  claims.take(frameOf(kStatusOf42));
  EXPECT_THAT(claims.unheard(), ElementsAre("wheel"));
}

TEST(DriveClaims, AnAnswerToAQuestionIsTheMotorsToo) {
  DriveClaims claims{{vesc()}};
  claims.take(frameOf(kPong42));
  EXPECT_TRUE(claims.of({"VESC", 42}));
  EXPECT_THAT(claims.unheard(), IsEmpty());
}

TEST(DriveClaims, ADriveOfAnotherFamilyUnderAMotorsIdCollides) {
  auto motor = wheel();
  motor.family = family("VESC");
  DriveClaims claims{{motor}};
  claims.take(frameOf(kDji1));
  const auto claim = claims.of({"DJI M3508 or M2006", 1});
  ASSERT_TRUE(claim);
  EXPECT_TRUE(claim->collides);
  EXPECT_THAT(claims.unheard(), ElementsAre("wheel")) << "it was somebody else";
}

KnownMotor damiao(std::uint32_t master_id, std::uint8_t id) {
  return {"arm",
          family("Damiao"),
          id,
          {FrameFilter{.id = {master_id, false},
                       .mask = kStandardIdMask,
                       .discriminators = {PayloadDiscriminator{0, 0x0F, id}}}},
          {}};
}

TEST(DriveClaims, ADamiaoWithTheMasterIdOfAnotherFamilyIsTheMotorOfTheFile) {
  DriveClaims claims{{damiao(0x201, 1)}};
  claims.take(frameOf("201#0104442010101E1E"));
  const auto claim = claims.of({"DJI M3508 or M2006", 1});
  ASSERT_TRUE(claim);
  EXPECT_FALSE(claim->collides);
  EXPECT_THAT(claims.unheard(), IsEmpty());
}

TEST(DriveClaims, TwoDamiaoWithOneMasterIdOfAnotherFamilyAreBothHeard) {
  auto second = damiao(0x201, 2);
  second.name = "wrist";
  DriveClaims claims{{damiao(0x201, 1), second}};
  claims.take(frameOf("201#0104442010101E1E"));
  EXPECT_THAT(claims.unheard(), ElementsAre("wrist"));
  claims.take(frameOf("201#0204442010101E1E"));
  EXPECT_THAT(claims.unheard(), IsEmpty());
}

TEST(DriveClaims, ADamiaoWhoseMasterIdIsNoOtherFamilysIsHeard) {
  DriveClaims claims{{damiao(0x7E0, 1)}};
  claims.take(frameOf("7E0#017FFF7FF7FF1E1E"));
  EXPECT_THAT(claims.unheard(), IsEmpty());
}

TEST(DriveClaims, ADriveThatSendsUnderTheMasterIdOfADamiaoCollides) {
  for (const bool first : {false, true}) {
    DriveClaims claims{{damiao(0x201, 1)}};
    if (first) claims.take(frameOf("201#0223004520121900"));
    claims.take(frameOf("201#0123004520121900"));
    if (!first) claims.take(frameOf("201#0223004520121900"));
    const auto claim = claims.of({"DJI M3508 or M2006", 1});
    ASSERT_TRUE(claim);
    EXPECT_TRUE(claim->collides) << first;
    EXPECT_THAT(claims.unheard(), ElementsAre("arm")) << first;
  }
}

TEST(DriveClaims, AQuestionThatCommandsAMotorOfTheFileIsFoundWhetherItIsHeardOrNot) {
  const DriveClaims claims{{vesc()}};
  EXPECT_EQ(claims.commandedBy(frameOf("0000012A#00000000")), "motor 'pump'");
  for (const auto& question : harmlessQueries()) EXPECT_EQ(claims.commandedBy(question), "");
}

TEST(DriveClaims, NoRobstrideIsAskedBesideAMotorThatItsAnswerWouldCommand) {
  auto motor = vesc();
  motor.id = 254;
  motor.steers = {FrameFilter{.id = {0x1FE, true}}};  // a current, and the answer of RobStride 1
  const DriveClaims claims{{motor}};
  EXPECT_EQ(claims.commandedBy(frameOf("0000FD01#0000000000000000")), "motor 'pump', by an answer");
  EXPECT_EQ(claims.commandedBy(frameOf("00001101#FE")), "motor 'pump', by an answer") << "type 0 as well";
  EXPECT_EQ(claims.commandedBy(frameOf("00001180#FE")), "") << "no RobStride has this id";
  std::size_t asked = 0;
  for (const auto& question : harmlessQueries()) asked += claims.commandedBy(question).empty() ? 1U : 0U;
  EXPECT_EQ(asked, 254U - 127U);
}

TEST(LinkSighting, TellsTheMotorOfEachGuess) {
  DriveClaims claims{{wheel()}};
  claims.take(frameOf(kDji1));
  BusSurvey survey;
  survey.take(frameOf(kDji1));
  const auto sightings = survey.sightings();
  ASSERT_EQ(sightings.size(), 1U);
  const auto told = linkSighting(sightings[0], "look", &claims);
  EXPECT_EQ(told.frame_id, 0x201U);
  EXPECT_EQ(told.frames, 1);
  EXPECT_EQ(told.advice.view(), "look");
  ASSERT_EQ(told.guess_count, 1U);
  EXPECT_EQ(told.guesses[0].kind.view(), "DJI M3508 or M2006");
  EXPECT_EQ(told.guesses[0].id, 1);
  EXPECT_EQ(told.guesses[0].motor.view(), "wheel");
  EXPECT_EQ(nameOf(told.guesses[0]), "DJI M3508 or M2006 id 1");
  EXPECT_EQ(linkSighting(sightings[0], "").guesses[0].motor.view(), "") << "no file is known";
}

}  // namespace
}  // namespace rc10::survey::drive_claims_test
