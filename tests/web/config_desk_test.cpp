#include "web/config_desk.hpp"

#include <poll.h>
#include <unistd.h>

#include <string>

#include <gmock/gmock.h>

namespace rc10::web::test::config_desk_test {
namespace {

std::string echo(std::string_view text) { return "\"" + std::string{text} + "\""; }
std::string other(std::string_view) { return "0"; }
std::string never(std::string_view) {
  while (true) ::pause();
}

class ConfigDeskTest : public ::testing::Test {
 protected:
  static ConfigDesk::Question question(std::uint64_t page, std::int64_t seq, const std::string& text,
                                       ConfigDesk::Work work = echo) {
    return {.page = page, .seq = seq, .head = "{\"of\":", .work = work, .input = text};
  }
  ConfigDesk::Answer next() {
    while (true) {
      if (auto answer = desk.turn(MonotonicTime{})) return std::move(*answer);
      (void)::poll(nullptr, 0, 1);
    }
  }
  ConfigDesk desk;
};

TEST_F(ConfigDeskTest, QuestionsAreAnsweredInTheirOrder) {
  desk.ask(question(1, 10, "a"));
  desk.ask(question(2, 20, "b"));
  const auto first = next();
  EXPECT_EQ(first.page, 1U);
  EXPECT_EQ(first.seq, 10);
  EXPECT_EQ(first.message.value(), "{\"of\":\"a\"}");
  EXPECT_EQ(next().message.value(), "{\"of\":\"b\"}");
  EXPECT_FALSE(desk.turn(MonotonicTime{}));
}

TEST_F(ConfigDeskTest, ANewerTextOfAPageTakesThePlaceOfOneThatWaits) {
  EXPECT_FALSE(desk.ask(question(1, 10, "a")));
  EXPECT_FALSE(desk.ask(question(2, 20, "b")));
  EXPECT_FALSE(desk.ask(question(1, 11, "c", other)));
  EXPECT_EQ(desk.ask(question(1, 12, "d")), 10);
  EXPECT_EQ(next().seq, 12);
  EXPECT_EQ(next().seq, 20);
  EXPECT_EQ(next().seq, 11);
}

TEST_F(ConfigDeskTest, WhatIsToFollowComesWithTheBareAnswer) {
  auto asked = question(1, 10, "a");
  asked.then =
      client::FileRequest{.verb = client::FileVerb::kRestart, .robot = "hero", .replaces = {}, .text = {}};
  desk.ask(std::move(asked));
  const auto answer = next();
  EXPECT_EQ(answer.message.value(), "\"a\"");
  ASSERT_TRUE(answer.then);
  EXPECT_EQ(answer.then->robot, "hero");
}

TEST_F(ConfigDeskTest, APageThatIsGoneKeepsNobodyWaiting) {
  desk.ask(question(1, 10, "a", never));
  EXPECT_FALSE(desk.turn(MonotonicTime{}));
  desk.ask(question(1, 11, "b"));
  desk.ask(question(2, 20, "c"));
  desk.forget(1);
  EXPECT_EQ(next().seq, 20);
  EXPECT_FALSE(desk.turn(MonotonicTime{}));
}

TEST_F(ConfigDeskTest, AQuestionWithoutAnEndIsAnsweredByAReason) {
  desk.ask(question(1, 10, "a", never));
  desk.ask(question(2, 20, "b"));
  EXPECT_FALSE(desk.turn(MonotonicTime{}));
  const auto given_up = desk.turn(MonotonicTime{} + ChildLimits{}.patience);
  ASSERT_TRUE(given_up);
  EXPECT_FALSE(given_up->message);
  EXPECT_EQ(next().seq, 20);
}

}  // namespace
}  // namespace rc10::web::test::config_desk_test
