#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "module/serial_link_board.hpp"

namespace rc10::test::serial_link_test {
namespace {

using namespace serial_link_board;

// ---- text

TEST(SerialLinkText, EveryLineOfATickIsHeard) {
  Board board{textLink()};
  EXPECT_TRUE(std::isnan(board.output("range_m")));
  board.run();
  board.hear(line("range,1250") + line("power,12,-0.5"));
  board.run();
  EXPECT_DOUBLE_EQ(board.output("range_m"), 1.25);
  EXPECT_DOUBLE_EQ(board.output("load_a"), -0.5);
  EXPECT_DOUBLE_EQ(board.output("connected"), 1.0);
  EXPECT_DOUBLE_EQ(board.output("age_ms"), 1.0);
  EXPECT_DOUBLE_EQ(board.output("errors"), 0.0);
}

TEST(SerialLinkText, OldValuesMeanNothingAndTheSilenceIsToldOnce) {
  Board board{textLink()};
  board.run();
  board.hear(line("range,1250") + line("power,12,-0.5"));
  board.run(200);
  EXPECT_DOUBLE_EQ(board.output("range_m"), 1.25);
  EXPECT_THAT(board.takeEvents(), IsEmpty());
  board.run(100);
  EXPECT_TRUE(std::isnan(board.output("range_m")));
  EXPECT_EQ(board.takeEvents(), (std::vector<std::size_t>{0}));
  board.hear(line("range,1250") + line("power,12,-0.5"));
  board.run();
  EXPECT_EQ(board.takeEvents(), (std::vector<std::size_t>{1}));
}

TEST(SerialLinkText, AWrongChecksumIsAnErrorAndNoValue) {
  Board board{textLink()};
  board.hear("$range,1250*28\n");
  board.run();
  EXPECT_TRUE(std::isnan(board.output("range_m")));
  EXPECT_DOUBLE_EQ(board.output("errors"), 1.0);
}

TEST(SerialLinkText, SendsSafeValuesAtItsRateUntilItIsCommanded) {
  Board board{textLink()};
  board.run(20);
  EXPECT_EQ(board.said(), line("claw,0.0000,1.0000") + line("lamp,0.0000"));
  board.run(20);
  EXPECT_EQ(board.said(), line("claw,0.0000,1.0000") + line("lamp,0.0000"));
  EXPECT_DOUBLE_EQ(board.output("claw_speed"), 1.0);
}

TEST(SerialLinkText, ACommandIsCutOffAtItsLimitsAndScaled) {
  Board board{textLink()};
  board.run(1001);  // a program that begins some time after the start
  (void)board.said();
  board.command({1000.0, 0.25, 3.0});
  board.run(20);
  EXPECT_EQ(board.said(), line("claw,90.0000,0.2500") + line("lamp,1.5000"));
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 90.0);
  EXPECT_DOUBLE_EQ(board.output("lamp"), 3.0);
}

TEST(SerialLinkText, WhoCommandedThroughAnEstopHasToCommandTheSafeValueOnce) {
  Board board{textLink()};
  board.run(1001);
  board.command({45.0, 2.0, 1.0});
  board.run();
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 45.0);
  board.robot().setState(RobotStatus::kEstop);
  board.run();
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 0.0);
  EXPECT_DOUBLE_EQ(board.output("lamp"), 1.0) << "on_estop: keep";
  board.robot().setState(RobotStatus::kRun);
  board.run(5);
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 0.0);
  EXPECT_EQ(board.takeEvents(), (std::vector<std::size_t>{2}));
  board.command({0.0, 1.0, 1.0});
  board.run();
  board.command({45.0, 1.0, 1.0});
  board.run();
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 45.0);
}

TEST(SerialLinkText, APortThatWasLostStartsWithSafeValues) {
  Board board{textLink()};
  board.run(1001);
  board.command({45.0, 2.0, 1.0});
  board.run();
  board.device().setState(SerialState::kAbsent);
  board.run();
  (void)board.said();
  board.run(20);
  EXPECT_EQ(board.said(), "");
  EXPECT_DOUBLE_EQ(board.output("connected"), 0.0);
  EXPECT_TRUE(std::isnan(board.output("claw_deg")));
  board.device().setState(SerialState::kOpen);
  board.run(20);
  EXPECT_THAT(board.said(), HasSubstr(line("claw,0.0000,1.0000")));
}

TEST(SerialLinkText, ASafeValueIsSentAtOnceWhateverTheRate) {
  Board board{settingsOf("text", {}, {{.name = "a", .message = "m"}}, 1)};
  board.run(1001);
  board.command({5.0});
  board.run(1001);
  EXPECT_THAT(board.said(), HasSubstr(line("m,5.0000")));
  board.run(100);
  EXPECT_EQ(board.said(), "");
  board.robot().setState(RobotStatus::kEstop);
  board.run();
  EXPECT_EQ(board.said(), line("m,0.0000"));
}

TEST(SerialLinkText, ALineThatIsBehindGetsNoMoreAndThenWhatIsNew) {
  Board board{settingsOf("text", {}, {{.name = "a", .message = "m"}})};
  board.run(1001);
  board.command({5.0});
  board.run(20);
  (void)board.said();
  board.jam(200);
  board.run(200);
  EXPECT_EQ(board.said(), "") << "nothing is queued behind what waits";
  EXPECT_GE(board.output("errors"), 9.0);
  board.robot().setState(RobotStatus::kEstop);
  board.run(5);
  EXPECT_EQ(board.said(), "");
  board.jam(0);
  board.run();
  EXPECT_EQ(board.said(), line("m,0.0000")) << "what is safe comes first";
}

TEST(SerialLinkText, AtTheEndOfTheProgramEveryFieldIsSafe) {
  Board board{textLink()};
  board.run(1001);
  board.command({45.0, 2.0, 3.0});
  board.run(20);
  (void)board.said();
  board.rest(1);
  EXPECT_EQ(board.said(), line("claw,0.0000,1.0000") + line("lamp,0.0000"));
}

TEST(SerialLinkText, NumbersAreWrittenInFull) {
  Board board{settingsOf("text", {}, {{.name = "a", .message = "m"}}, 250)};
  board.run(1001);
  for (const auto& [value, text] :
       {std::pair{-0.00004, "-0.0000"}, std::pair{123456.78915, "123456.7892"},
        std::pair{-1e9, "-999999999.0000"}, std::pair{9.99996, "10.0000"}, std::pair{-0.5, "-0.5000"}}) {
    (void)board.said();
    board.command({value});
    board.run(4);
    EXPECT_THAT(board.said(), HasSubstr("$m," + std::string{text} + "*")) << value;
  }
}

// ---- cobs

Bytes frameOf(const Bytes& content) { return HeardCobs::packed(content); }

TEST(SerialLinkCobs, FieldsFollowEachOtherInTheOrderOfTheList) {
  Board board{settingsOf("cobs",
                         {{.name = "a", .message = "7", .type = "i16", .scale = 0.1},
                          {.name = "other", .message = "8", .type = "u8"},
                          {.name = "b", .message = "7", .type = "f32"}},
                         {{.name = "x", .message = "1", .type = "u8"},
                          {.name = "y", .message = "1", .type = "i32", .scale = 0.001}})};
  board.run(1001);
  (void)board.said();
  // -2 and 1.0F, lowest byte first.
  board.hear(joined({frameOf({7, 0xFE, 0xFF, 0x00, 0x00, 0x80, 0x3F}), frameOf({8, 200})}));
  board.command({300.0, -1.5});
  board.run(20);
  EXPECT_DOUBLE_EQ(board.output("a"), -0.2);
  EXPECT_DOUBLE_EQ(board.output("b"), 1.0);
  EXPECT_DOUBLE_EQ(board.output("other"), 200.0);
  // 300 is cut off at 255; -1500.
  EXPECT_EQ(board.saidBytes(), frameOf({1, 255, 0x24, 0xFA, 0xFF, 0xFF}));
}

TEST(SerialLinkCobs, AMessageOfAnotherSizeIsAnErrorAndOfAnotherNumberNothing) {
  Board board{settingsOf("cobs", {{.name = "a", .message = "7", .type = "i16"}}, {})};
  board.hear(frameOf({7, 1}));
  board.hear(frameOf({6, 1, 2}));
  board.run();
  EXPECT_TRUE(std::isnan(board.output("a")));
  EXPECT_DOUBLE_EQ(board.output("errors"), 1.0);
}

// ---- what the configuration may say

std::string errorOf(const ModuleSettings& settings) {
  const auto built = serialLinkType().build(settings, outlineOf(1));
  return built ? "" : built.error().message;
}

TEST(SerialLinkKeys, EachMistakeIsNamedWithItsPlace) {
  using Rows = std::vector<Row>;
  struct Wrong {
    std::string protocol;
    Rows receive;
    Rows send;
    std::string error;
  };
  for (const auto& wrong : std::vector<Wrong>{
           {"text", {}, {}, "receive: there is no field"},
           {"text", {{.name = "a"}}, {}, "receive[0].message: missing"},
           {"text",
            {{.name = "a", .message = "m"}},
            {{.name = "a", .message = "n"}},
            "send[0].name: there is a signal 'a'"},
           {"text", {{.name = "errors", .message = "m"}}, {}, "receive[0].name: there is a signal 'errors'"},
           {"text",
            {{.name = "a", .message = "m"}, {.name = "b", .message = "m"}},
            {},
            "receive[1].place: 'a' has it"},
           {"text",
            {},
            {{.name = "a", .message = "m", .place = 2}},
            "send[0].place: no field is number 1 of 'm'"},
           {"text",
            {},
            {{.name = "a", .message = "m", .place = 7}},
            "send[0].place: a line that is sent has room"},
           {"text", {{.name = "a", .message = "m", .scale = 0.0}}, {}, "receive[0].scale: 0"},
           {"cobs", {{.name = "a", .message = "256"}}, {}, "receive[0].message: '256' is no number"},
           {"cobs", {{.name = "a", .message = "x"}}, {}, "receive[0].message: 'x' is no number"},
           {"modbus", {{.name = "a"}}, {}, "receive[0].register: missing"},
           {"modbus", {{.name = "a", .reg = 1, .type = "u8"}}, {}, "receive[0].type: u8 is no register"},
           {"modbus", {{.name = "a", .reg = 65535}}, {}, "receive[0].register: 65535 is the last"},
           {"modbus",
            {{.name = "a", .reg = 1, .type = "u32"}, {.name = "b", .reg = 2, .type = "u16"}},
            {},
            "receive[1].register: 'a' has it"},
           {"text", {}, {{.name = "a", .message = "m", .low = 2, .high = 1}}, "send[0].min: it is above max"},
           {"text",
            {},
            {{.name = "a", .message = "m", .safe = 5, .high = 1}},
            "send[0].safe_value: it is not between"}}) {
    EXPECT_THAT(errorOf(settingsOf(wrong.protocol, wrong.receive, wrong.send)), HasSubstr(wrong.error));
  }
  EXPECT_THAT(errorOf(settingsOf("cobs", {}, {{.name = "a", .message = "1", .type = "u16", .safe = -10}})),
              HasSubstr("send[0].safe_value: the field can say 0 to 65535"));
  EXPECT_THAT(errorOf(settingsOf("text", {}, {{.name = "a", .message = "m"}}, 500)),
              HasSubstr("rate_hz: the fields are up to 22 bytes, and 115200 8N1 carries them 366 times"));
  EXPECT_EQ(errorOf(settingsOf("modbus",
                               {{.name = "a", .reg = 1, .type = "u16"},
                                {.name = "b", .reg = 1, .type = "u16", .input_register = true}},
                               {})),
            "");
}

}  // namespace
}  // namespace rc10::test::serial_link_test
