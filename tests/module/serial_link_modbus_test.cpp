#include <cmath>

#include <gtest/gtest.h>

#include "module/serial_link_board.hpp"

namespace rc10::test::serial_link_modbus_test {
namespace {

using namespace serial_link_board;

// ---- modbus

ModuleSettings modbusLink() {
  return settingsOf("modbus",
                    {{.name = "temperature_c", .reg = 10, .type = "i16", .scale = 0.1},
                     {.name = "energy", .reg = 11, .type = "u32"},
                     {.name = "level", .reg = 2, .type = "u16", .input_register = true}},
                    {{.name = "pump", .reg = 100, .type = "u16"}});
}

/// A frame with its checksum, which the protocol of another module computes.
Bytes modbusFrame(const Bytes& content) {
  Bytes out(content.size() + 2);
  out.resize(ModbusRtu{}.pack_frame(content, out));
  return out;
}

TEST(SerialLinkModbus, WritesAndReadsItsRegistersInTurn) {
  Board board{modbusLink()};
  board.run(1001);
  board.hear(modbusFrame({3, 6, 0, 100, 0, 0}));  // the answer to the first write
  board.command({7.0});
  (void)board.said();
  Bytes said;
  std::vector<Bytes> questions;
  for (int i = 0; i < 400 && questions.size() < 3; ++i) {
    board.run();
    const auto bytes = board.saidBytes();
    if (bytes.empty()) continue;
    if (bytes[1] == 6 && bytes[5] == 7) {
      questions.push_back(bytes);
      board.hear(bytes);  // a write is answered by itself
    } else if (bytes[1] == 6) {
      board.hear(bytes);
    } else if (bytes[1] == 3) {
      if (!questions.empty()) questions.push_back(bytes);
      board.hear(modbusFrame({3, 3, 6, 0xFF, 0x9C, 0x00, 0x01, 0x00, 0x02}));
    } else {
      if (questions.size() == 2) questions.push_back(bytes);
      board.hear(modbusFrame({3, 4, 2, 0x12, 0x34}));
    }
  }
  board.run(2);
  ASSERT_EQ(questions.size(), 3U);
  EXPECT_EQ(questions[0], modbusFrame({3, 6, 0, 100, 0, 7}));
  EXPECT_EQ(questions[1], modbusFrame({3, 3, 0, 10, 0, 3})) << "neighbours in one question";
  EXPECT_EQ(questions[2], modbusFrame({3, 4, 0, 2, 0, 1}));
  EXPECT_DOUBLE_EQ(board.output("temperature_c"), -10.0);
  EXPECT_DOUBLE_EQ(board.output("energy"), 65538.0);
  EXPECT_DOUBLE_EQ(board.output("level"), 0x1234);
}

// Two questions that look alike: an answer does not say to which it belongs.
TEST(SerialLinkModbus, ALateAnswerIsNotTakenForThatToTheNextQuestion) {
  Board board{settingsOf(
      "modbus", {{.name = "a", .reg = 0, .type = "u16"}, {.name = "b", .reg = 10, .type = "u16"}}, {})};
  const auto question_a = modbusFrame({3, 3, 0, 0, 0, 1});
  for (int i = 0; i < 100 && board.saidBytes() != question_a; ++i) board.run();
  board.run(58);  // its time is over
  board.hear(modbusFrame({3, 3, 2, 0x11, 0x11}));
  board.run(1);
  EXPECT_TRUE(std::isnan(board.output("a")));
  board.run(100);
  EXPECT_TRUE(std::isnan(board.output("b")));
  EXPECT_EQ(board.saidBytes(), modbusFrame({3, 3, 0, 10, 0, 1})) << "asked when the late one has passed";
  board.hear(modbusFrame({3, 3, 2, 0x22, 0x22}));
  board.run(2);
  EXPECT_DOUBLE_EQ(board.output("b"), 0x2222);
  EXPECT_GE(board.output("errors"), 1.0);
}

TEST(SerialLinkModbus, AnEstopIsWrittenBeforeTheRoundGoesOn) {
  Board board{modbusLink()};
  board.run(1001);
  const auto answerTo = [&](const Bytes& question) {
    if (question[1] == 6) board.hear(question);
    if (question[1] == 3) board.hear(modbusFrame({3, 3, 6, 0, 0, 0, 0, 0, 0}));
    if (question[1] == 4) board.hear(modbusFrame({3, 4, 2, 0, 0}));
  };
  const auto next = [&] {
    for (int i = 0; i < 200; ++i) {
      const auto said = board.saidBytes();
      if (!said.empty()) return said;
      board.run();
    }
    return Bytes{0, 0};
  };
  board.command({7.0});
  Bytes question;
  for (int i = 0; i < 20 && question != modbusFrame({3, 6, 0, 100, 0, 7}); ++i) answerTo(question = next());
  question = next();
  ASSERT_EQ(question[1], 3);  // the round goes on with its reading
  board.robot().setState(RobotStatus::kEstop);
  board.run();
  answerTo(question);
  EXPECT_EQ(next(), modbusFrame({3, 6, 0, 100, 0, 0}));
}

TEST(SerialLinkModbus, ASlaveThatDoesNotAnswerIsAskedAgainAndCounted) {
  Board board{modbusLink()};
  board.run(600);
  EXPECT_GE(board.output("errors"), 3.0);
  EXPECT_TRUE(std::isnan(board.output("level")));
  EXPECT_FALSE(board.said().empty());
}

}  // namespace
}  // namespace rc10::test::serial_link_modbus_test
