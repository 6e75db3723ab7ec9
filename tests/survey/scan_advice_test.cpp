#include "survey/scan_advice.hpp"

#include <gmock/gmock.h>

#include "bus/frame_text.hpp"

namespace rc10::survey::scan_advice_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

std::vector<Sighting> heard(std::initializer_list<const char*> frames) {
  BusSurvey survey;
  for (const char* text : frames) survey.take(parseFrameText(text).value_or(CanFrame{}));
  return survey.sightings();
}

constexpr const char* kPong42 = "000012FE#2A";
constexpr const char* kStatusOf42 = "0000092A#0000271000640064";
constexpr const char* kStatusOf104 = "00000968#0000271000640064";

TEST(ScanAdvice, AVescThatOnlyAnswersIsToldToSendItsStatus) {
  const auto all = heard({kPong42});
  ASSERT_THAT(all, SizeIs(1));
  EXPECT_TRUE(isSilent(all[0], all));
  EXPECT_THAT(adviceFor(all[0], all), AllOf(HasSubstr("VESC id 42 answers but sends no status"),
                                            HasSubstr("CAN Status Rate 1 = 100 Hz")));
}

TEST(ScanAdvice, AVescThatSendsItsStatusNeedsNothing) {
  const auto all = heard({kPong42, kStatusOf42});
  ASSERT_THAT(all, SizeIs(2));
  for (const auto& sighting : all) EXPECT_EQ(adviceFor(sighting, all), "");
}

TEST(ScanAdvice, AnotherVescsStatusIsNotItsOwn) {
  const auto all = heard({kPong42, kStatusOf104});
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(adviceFor(all[0], all), "");
  EXPECT_TRUE(isSilent(all[1], all));
}

TEST(ScanAdvice, WhatIsAmbiguousOrUnknownIsToldSo) {
  const auto ambiguous = heard({"206#1FFF12C0FA240000"});
  EXPECT_THAT(adviceFor(ambiguous[0], ambiguous), HasSubstr("label"));
  const auto unknown = heard({"7FE#01"});
  EXPECT_THAT(adviceFor(unknown[0], unknown), HasSubstr("no family"));
}

TEST(ScanAdvice, OfASilentBusTheWiringIsToBeChecked) {
  EXPECT_THAT(adviceForBus({}, {})[0], HasSubstr("nothing was heard: check the drives' power"));
  EXPECT_THAT(adviceForBus(heard({kPong42}), {}), SizeIs(1));
}

TEST(ScanAdvice, WhoWasNotAskedIsTold) {
  const auto advice = adviceForBus(
      heard({kPong42}), {.listen_only = true, .spared = {"an ODrive with extended ids, node 136"}});
  ASSERT_THAT(advice, SizeIs(3));
  EXPECT_EQ(
      advice[0],
      "not all VESC, RobStride and CyberGear ids were asked: an ODrive with extended ids, node 136, would "
      "take the questions for commands");
  EXPECT_THAT(advice[1],
              StartsWith("CubeMars (MIT), Damiao, LK-Tech, MyActuator and moteus drives speak only when"));
  EXPECT_EQ(
      advice[2],
      "Nothing was asked (--listen-only): VESC as delivered, RobStride and CyberGear may be silent too.");
}

}  // namespace
}  // namespace rc10::survey::scan_advice_test
