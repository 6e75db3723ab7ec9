#include "web/page_request.hpp"

#include <random>
#include <string>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::web::test::page_request_test {
namespace {

template <typename Wanted>
Wanted parsed(std::string_view text) {
  const auto request = parsePageRequest(text);
  EXPECT_TRUE(request) << text << ": " << (request ? "" : request.error().message);
  const auto* found = request ? std::get_if<Wanted>(&*request) : nullptr;
  EXPECT_NE(found, nullptr);
  return found != nullptr ? *found : Wanted{};
}

TEST(PageRequest, AViewHasItsSignalsWidthAndSpan) {
  const auto view = parsed<ChooseView>(
      R"({"type":"view","view":3,"signals":["yaw.velocity_rpm","base.vx"],"column_us":12500,"span_us":1e7})");
  EXPECT_EQ(view.view, 3U);
  EXPECT_THAT(view.signals, ::testing::ElementsAre("yaw.velocity_rpm", "base.vx"));
  EXPECT_EQ(view.column_us, 12'500);
  EXPECT_EQ(view.span_us, 10'000'000);
}

TEST(PageRequest, AnOperationHasItsTargetAndValues) {
  const auto ask = parsed<AskRobot>(
      R"({"type":"request","seq":9,"sent_us":5000,"operation":"zero","target":"yaw","values":{"angle_deg":-12.5}})");
  EXPECT_EQ(ask.seq, 9);
  EXPECT_EQ(ask.sent, std::chrono::milliseconds{5});
  EXPECT_EQ(ask.operation, "zero");
  EXPECT_EQ(ask.target, "yaw");
  ASSERT_EQ(ask.values.size(), 1U);
  EXPECT_EQ(ask.values[0].first, "angle_deg");
  EXPECT_EQ(ask.values[0].second, -12.5);
}

TEST(PageRequest, OnlyWhatStopsNeedsNoTime) {
  EXPECT_FALSE(parsed<AskRobot>(R"({"type":"request","seq":9,"operation":"disable","sent_us":1})").sent);
  for (const auto* text :
       {R"({"type":"request","seq":9,"operation":"enable","target":"yaw"})",
        R"({"type":"request","seq":9,"operation":"clear","sent_us":"now"})",
        R"({"type":"config_install","seq":9,"text":"robot: a"})", R"({"type":"config_restart","seq":9})"}) {
    const auto request = parsePageRequest(text);
    ASSERT_FALSE(request) << text;
    EXPECT_THAT(request.error().message, ::testing::HasSubstr("sent_us")) << text;
  }
}

TEST(PageRequest, AnEstopCountsWhateverElseItsMessageSays) {
  for (const auto* text :
       {R"({"type":"request","operation":"estop"})", R"({"type":"estop"})",
        R"({"type":"request","seq":-1e400,"operation":"estop","target":7,"values":[1,2]})",
        R"({"type":"estop","seq":"x","operation":null})", R"({"operation":"estop","type":[]})"})
    EXPECT_EQ(parsed<AskRobot>(text).operation, "estop") << text;
}

TEST(PageRequest, ARefusedMessageHasTheNumberByWhichThePageKnowsItsAnswer) {
  constexpr std::string_view kTest = R"({"type":"test","schema":99,"seq":7})";
  EXPECT_FALSE(parsePageRequest(kTest));
  EXPECT_EQ(numberOf(kTest), 7);
  constexpr std::string_view kRecording = R"({"type":"recording","number":8})";
  EXPECT_FALSE(parsePageRequest(kRecording));
  EXPECT_EQ(numberOf(kRecording), 8);
  for (const auto* without :
       {"", "[1]", R"({"seq":-1})", R"({"seq":"9"})", R"({"seq":1e300})", R"({"number":{}})"})
    EXPECT_EQ(numberOf(without), 0) << without;
}

TEST(PageRequest, AHeldMotorHasItsTargetAndTheTimeOfThePage) {
  const auto drive = parsed<DriveMotor>(
      R"({"type":"drive","seq":4,"motor":"yaw","mode":"velocity","value":-20.5,"sent_us":1500,"held":true})");
  EXPECT_EQ(drive.seq, 4);
  EXPECT_EQ(drive.motor, "yaw");
  EXPECT_EQ(drive.mode, ControlMode::kVelocity);
  EXPECT_EQ(drive.value, -20.5);
  EXPECT_EQ(drive.sent, std::chrono::microseconds{1500});
  EXPECT_TRUE(drive.held);
  const auto let_go =
      parsed<DriveMotor>(R"({"type":"drive","seq":4,"motor":"yaw","mode":"current","value":1,"sent_us":0})");
  EXPECT_EQ(let_go.mode, ControlMode::kCurrent);
  EXPECT_FALSE(let_go.held) << "what does not say that it is held is not";
}

TEST(PageRequest, ThePageTellsItsClock) {
  EXPECT_EQ(parsed<TellClock>(R"({"type":"clock","sent_us":2500000})").sent, std::chrono::milliseconds{2500});
}

TEST(PageRequest, ARecordingIsAskedForByItsNameAndThenPieceByPiece) {
  EXPECT_EQ(parsed<AskRecordings>(R"({"type":"recordings","seq":5})").seq, 5);
  const auto recording = parsed<AskRecording>(R"({"type":"recording","number":6,"name":"hero.blackbox"})");
  EXPECT_EQ(recording.number, 6U);
  EXPECT_EQ(recording.name, "hero.blackbox");
  EXPECT_EQ(parsed<AskPiece>(R"({"type":"piece","number":6})").number, 6U);
}

TEST(PageRequest, WordsAreAskedForEventsAndFrames) {
  const auto words = parsed<AskWords>(
      R"({"type":"words","seq":2,"events":[[101,3,-1,"teleop"]],"buses":[["M3508","GM6020"]],)"
      R"("frames":[[0,true,"200#00"]]})");
  ASSERT_EQ(words.events.size(), 1U);
  EXPECT_EQ(words.events[0].extra, -1);
  EXPECT_EQ(words.events[0].client, "teleop");
  ASSERT_EQ(words.frames.size(), 1U);
  EXPECT_TRUE(words.frames[0].sent);
  EXPECT_EQ(words.frames[0].text, "200#00");
  EXPECT_THAT(words.buses[words.frames[0].bus], ::testing::ElementsAre("M3508", "GM6020"));
}

std::string framesAsked(std::size_t count) {
  std::string frames;
  for (std::size_t i = 0; i < count; ++i) frames += (i == 0 ? "" : ",") + std::string{R"([0,true,"200#00"])"};
  return R"({"type":"words","seq":2,"events":[],"buses":[["M3508"]],"frames":[)" + frames + "]}";
}

TEST(PageRequest, WordsOfMoreFramesThanPagesMayWaitForAreRefused) {
  EXPECT_EQ(parsed<AskWords>(framesAsked(AskWords::kMostFrames)).frames.size(), AskWords::kMostFrames);
  EXPECT_FALSE(parsePageRequest(framesAsked(AskWords::kMostFrames + 1)));
}

std::string testWith(const std::string& more) {
  return R"({"type":"test","schema":1,"seq":7,"sent_us":1500,"motor":"wheel","kind":"sweep","mode":"velocity",)"
         R"("amplitude":20,"max_current_a":12)" +
         more + "}";
}

TEST(PageRequest, ATestOfMotionHasItsShapeItsBoundsAndTheTimeOfThePage) {
  const auto test = parsed<StartTest>(
      testWith(R"(,"base":-60.5,"seconds":12,"from_hz":2,"to_hz":30,"linear":true,"max_speed_rpm":100,)"
               R"("min_angle_deg":-5,"max_angle_deg":null,"max_feedback_age_ms":150,"stop_at_limits":true,)"
               R"("dead_man_ms":300,"priority":2)"));
  EXPECT_EQ(test.seq, 7);
  EXPECT_EQ(test.sent, std::chrono::microseconds{1500});
  EXPECT_EQ(test.plan.motor, "wheel");
  EXPECT_EQ(test.plan.kind, client::ExcitationKind::kSweep);
  EXPECT_EQ(test.plan.mode, ControlMode::kVelocity);
  EXPECT_EQ(test.plan.amplitude, 20.0);
  EXPECT_EQ(test.plan.base, -60.5);
  EXPECT_EQ(test.plan.time_s, 12.0);
  EXPECT_EQ(test.plan.rate_per_s, std::nullopt);
  EXPECT_EQ(test.plan.from_hz, 2.0);
  EXPECT_EQ(test.plan.to_hz, 30.0);
  EXPECT_TRUE(test.plan.linear);
  EXPECT_EQ(test.plan.max_current_a, 12.0);
  EXPECT_EQ(test.plan.max_speed_rpm, 100.0);
  EXPECT_EQ(test.plan.min_angle_deg, -5.0);
  EXPECT_EQ(test.plan.max_angle_deg, std::nullopt);
  EXPECT_EQ(test.plan.max_feedback_age_s, 0.15);
  EXPECT_TRUE(test.plan.stop_at_limits);
  EXPECT_EQ(test.plan.dead_man_ms, 300);
  EXPECT_EQ(test.priority, 2);
  // As rc10ctl has them.
  const auto bare = parsed<StartTest>(testWith(""));
  EXPECT_EQ(bare.plan.dead_man_ms, 200);
  EXPECT_EQ(bare.plan.max_feedback_age_s, 0.2);
}

TEST(PageRequest, ATestIsRenewedEndedAndItsCurveAskedForByItsNumber) {
  const auto renewal = parsed<RenewTest>(R"({"type":"test_renewal","seq":7,"sent_us":9})");
  EXPECT_EQ(renewal.seq, 7);
  EXPECT_EQ(renewal.sent, std::chrono::microseconds{9});
  EXPECT_EQ(parsed<EndTest>(R"({"type":"test_end","seq":7,"why":"left"})").why, TestEnd::kLeft);
  EXPECT_EQ(parsed<EndTest>(R"({"type":"test_end","seq":7})").why, TestEnd::kStopped);
  EXPECT_EQ(parsed<AskCurve>(R"({"type":"curve","seq":7,"first":4096})").first, 4096U);
}

TEST(PageRequest, ATestWithAWordThatIsNotKnownIsRefusedForItMayHaveBeenABound) {
  const auto mistake = [](const std::string& text) {
    const auto request = parsePageRequest(text);
    return request ? std::string{} : request.error().message;
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(mistake(testWith(R"(,"max_sped_rpm":100)")), HasSubstr("a test has no 'max_sped_rpm'"));
  EXPECT_THAT(mistake(testWith(R"(,"max_speed_rpm":"100")")), HasSubstr("'max_speed_rpm' is not a number"));
  EXPECT_THAT(mistake(testWith(R"(,"linear":1)")), HasSubstr("'linear' is not true or false"));
  EXPECT_THAT(mistake(testWith(R"(,"dead_man_ms":1e12)")), HasSubstr("'dead_man_ms' is not a number"));
  EXPECT_THAT(mistake(testWith(R"(,"kind":"wave")")), HasSubstr("'kind' is not step"));
  EXPECT_THAT(mistake(R"({"type":"test","schema":2,"seq":7,"sent_us":1})"), HasSubstr("load the page anew"));
  EXPECT_THAT(mistake(R"({"type":"test","seq":7,"sent_us":1})"), HasSubstr("'schema' of a test is 1"));
  EXPECT_THAT(mistake(R"({"type":"test","schema":1,"seq":7,"sent_us":1,"motor":"wheel","kind":"step"})"),
              HasSubstr("'mode' is not"));
  EXPECT_THAT(mistake(R"({"type":"test","schema":1,"seq":7,"sent_us":1,"motor":"wheel","kind":"step",)"
                      R"("mode":"velocity","amplitude":1})"),
              HasSubstr("'max_current_a' is not a number"));
}

TEST(PageRequest, WhatIsWrongIsRefusedInWords) {
  const std::string long_text(2000, 'x');
  for (const auto& text : std::initializer_list<std::string>{
           "",
           "null",
           "[]",
           "{",
           "{}",
           R"({"type":"shutdown"})",
           R"({"type":7})",
           R"({"type":"clock"})",
           R"({"type":"recordings"})",
           R"({"type":"recording","number":1})",
           R"({"type":"recording","number":-1,"name":"a"})",
           R"({"type":"piece"})",
           R"({"type":"words","seq":1})",
           R"({"type":"words","seq":1,"events":{},"buses":[],"frames":[]})",
           R"({"type":"words","seq":1,"events":[[1,2,3]],"buses":[],"frames":[]})",
           R"({"type":"words","seq":1,"events":[[1,2,3,4]],"buses":[],"frames":[]})",
           R"({"type":"words","seq":1,"events":[[1,2,1e10,"a"]],"buses":[],"frames":[]})",
           R"({"type":"words","seq":1,"events":[[1,2,99999999999,"a"]],"buses":[],"frames":[]})",
           R"({"type":"words","seq":1,"events":[],"buses":[],"frames":[[0,true,"200#"]]})",
           R"({"type":"words","seq":1,"events":[],"buses":[[]],"frames":[[-1,true,"200#"]]})",
           R"({"type":"words","seq":1,"events":[],"buses":[[1]],"frames":[]})",
           R"({"type":"words","seq":1,"events":[],"buses":[[],[],[],[],[]],"frames":[]})",
           R"({"type":"clock","sent_us":-1})",
           R"({"type":"test_renewal","seq":7})",
           R"({"type":"test_renewal","sent_us":7})",
           R"({"type":"test_end"})",
           R"({"type":"curve","seq":7,"first":-1})",
           R"({"type":"curve","seq":7})",
           R"({"type":"drive","seq":1,"motor":"yaw","mode":"velocity","value":1})",
           R"({"type":"drive","seq":1,"mode":"velocity","value":1,"sent_us":1})",
           R"({"type":"drive","seq":1,"motor":"yaw","mode":"impedance","value":1,"sent_us":1})",
           R"({"type":"drive","seq":1,"motor":"yaw","mode":"velocity","value":"1","sent_us":1})",
           R"({"type":"drive","seq":1,"motor":"yaw","mode":"velocity","value":1e7,"sent_us":1})",
           R"({"type":"drive","seq":-1,"motor":"yaw","mode":"velocity","value":1,"sent_us":1})",
           R"({"type":"view","view":1,"signals":"yaw","column_us":1000,"span_us":1})",
           R"({"type":"view","view":1,"signals":[1],"column_us":1000,"span_us":1})",
           R"({"type":"view","view":-1,"signals":[],"column_us":1000,"span_us":1})",
           R"({"type":"view","view":1,"signals":[],"column_us":0,"span_us":1})",
           R"({"type":"view","view":1,"signals":[],"column_us":1e300,"span_us":1})",
           R"({"type":"range","first_column":1e15,"column_us":60000000,"count":1})",
           R"({"type":"range","first_column":-1,"column_us":1000,"count":1})",
           R"({"type":"range","first_column":1,"column_us":1000,"count":100000})",
           R"({"type":"request","seq":1,"operation":""})",
           R"({"type":"request","operation":"enable"})",
           R"({"type":"request","seq":1,"operation":")" + long_text + "\"}",
           R"({"type":"request","seq":1,"sent_us":1,"operation":"enable","target":")" + long_text + "\"}",
           R"({"type":"request","seq":1,"sent_us":1,"operation":"zero","values":{"angle_deg":"1"}})",
           R"({"type":"request","seq":1,"sent_us":1,"operation":"zero","values":{")" + long_text +
               R"(":1}})"}) {
    const auto request = parsePageRequest(text);
    EXPECT_FALSE(request) << text.substr(0, 80);
    if (!request) {
      EXPECT_FALSE(request.error().message.empty());
    }
  }
  std::string many = R"({"type":"view","view":1,"column_us":1000,"span_us":1,"signals":["a")";
  for (int i = 0; i < 40; ++i) many += R"(,"a")";
  EXPECT_FALSE(parsePageRequest(many + "]}"));
}

TEST(PageRequest, ATextToCheckHasANumberAndABound) {
  const auto asked = parsePageRequest(R"({"type":"config_check","seq":4,"text":"on_estop: \"estop\"\n"})");
  ASSERT_TRUE(asked);
  const auto* check = std::get_if<CheckConfig>(&*asked);
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->seq, 4);
  EXPECT_EQ(check->text, "on_estop: \"estop\"\n");
  const auto of_size = [](std::size_t size) {
    return R"({"type":"config_check","seq":4,"text":")" + std::string(size, 'x') + "\"}";
  };
  EXPECT_TRUE(parsePageRequest(of_size(CheckConfig::kMostBytes)));
  EXPECT_FALSE(parsePageRequest(of_size(CheckConfig::kMostBytes + 1)));
  for (const std::string text :
       {R"({"type":"config"})", R"({"type":"config_check","text":""})", R"({"type":"config_check","seq":1})",
        R"({"type":"config_check","seq":1,"text":[]})"})
    EXPECT_FALSE(parsePageRequest(text)) << text;
}

TEST(PageRequest, NeitherDeepNorRandomTextDoesHarm) {
  EXPECT_FALSE(parsePageRequest(std::string(60'000, '[')));
  std::mt19937 random{3};
  std::uniform_int_distribution<int> byte{0, 255};
  const std::string good =
      R"({"type":"view","view":3,"signals":["yaw.velocity_rpm"],"column_us":12500,"span_us":1e7})";
  for (int i = 0; i < 20'000; ++i) {
    std::string text = good;
    for (int n = 0; n < 3; ++n)
      text[static_cast<std::size_t>(byte(random)) % text.size()] = static_cast<char>(byte(random));
    (void)parsePageRequest(text);
  }
}

}  // namespace
}  // namespace rc10::web::test::page_request_test
