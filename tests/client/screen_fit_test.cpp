#include "client/screen_fit.hpp"

#include <gmock/gmock.h>

#include "app/style.hpp"
#include "client/sparkline.hpp"

namespace rc10::client::screen_fit_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Picture robotOf(std::size_t motors) {
  Picture picture{.text = "robot hero\nbus can0\nbus can1\nMOTOR  STATUS\n",
                  .motors = motors,
                  .modules = {},
                  .below = "spark\n"};
  for (std::size_t i = 0; i < motors; ++i) picture.text += "m" + std::to_string(i) + "  ACTIVE\n";
  return picture;
}

std::size_t rowsOf(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string line(const std::string& text, std::size_t columns) {
  return fitted({.text = text + "\n", .motors = 0, .modules = {}, .below = {}},
                {.columns = columns, .rows = 0});
}

TEST(ScreenFit, WhereThereIsRoomNothingChanges) {
  const auto picture = robotOf(3);
  EXPECT_EQ(fitted(picture, {.columns = 80, .rows = 24}), picture.text + picture.below);
  EXPECT_EQ(fitted(picture, {.columns = 14, .rows = 9}), picture.text + picture.below);
}

TEST(ScreenFit, OfAnUnknownTerminalNothingIsCut) {
  const auto picture = robotOf(100);
  EXPECT_EQ(fitted(picture, {}), picture.text + picture.below);
}

TEST(ScreenFit, TheLastColumnStaysFree) {
  EXPECT_EQ(line("1234567", 8), "1234567\n");
  EXPECT_EQ(line("12345678", 8), "1234567\n");
  EXPECT_EQ(line("12345678", 1), "1\n");
}

TEST(ScreenFit, MarksOfASparklineCountOnceAndStayWhole) {
  Sparkline spark(10);
  for (int i = 0; i < 10; ++i) spark.add(i);
  const auto marks = spark.text(true);
  ASSERT_EQ(marks.size(), 30U);
  EXPECT_EQ(line(marks, 11), marks + "\n");
  EXPECT_EQ(line(marks, 5), marks.substr(0, 12) + "\n");
}

TEST(ScreenFit, ColoursHaveNoWidthAndEndBehindTheCut) {
  const auto red = style::styled("yaw FAULT", style::kBad);
  EXPECT_EQ(line(red, 10), red + "\n");
  EXPECT_EQ(line(red, 4), style::styled("yaw", style::kBad) + "\n");
  EXPECT_EQ(line("ab" + style::styled("cd", style::kGood) + "ef", 4),
            "ab" + style::styled("c", style::kGood) + "\n");
}

TEST(ScreenFit, ASequenceThatDoesNotEndIsNotReadBeyondTheLine) {
  EXPECT_EQ(line("ab\x1b[1", 8), "ab\x1b[1\n");
  EXPECT_EQ(line("ab\x1b", 8), "ab\x1b\n");
}

TEST(ScreenFit, MotorsWithoutARowAreCounted) {
  const auto shown = fitted(robotOf(32), {.columns = 80, .rows = 24});
  EXPECT_EQ(rowsOf(shown), 23U);
  EXPECT_THAT(
      shown, HasSubstr("m16  ACTIVE\n15 of 32 motors are not shown: the terminal has too few rows\nspark\n"));
  EXPECT_THAT(shown, Not(HasSubstr("m17")));
}

TEST(ScreenFit, ByOneRowTooFewTwoMotorsMakeRoomForTheNotice) {
  EXPECT_THAT(fitted(robotOf(4), {.columns = 80, .rows = 9}), HasSubstr("m1  ACTIVE\n2 of 4 motors"));
}

TEST(ScreenFit, OnFewRowsTheHeadlineTheNoticeAndWhatIsBelowRemain) {
  EXPECT_EQ(fitted(robotOf(4), {.columns = 80, .rows = 4}),
            "robot hero\n4 of 4 motors are not shown: the terminal has too few rows\nspark\n");
  for (std::size_t rows = 2; rows < 12; ++rows) {
    const auto shown = fitted(robotOf(4), {.columns = 80, .rows = rows});
    EXPECT_LT(rowsOf(shown), rows);
    EXPECT_THAT(shown, StartsWith("robot hero\n"));
  }
}

TEST(ScreenFit, ModulesMakeRoomBeforeAnyMotor) {
  auto picture = robotOf(3);
  for (int i = 0; i < 5; ++i) picture.modules += "module " + std::to_string(i) + "\n";
  EXPECT_EQ(fitted(picture, {.columns = 80, .rows = 24}), picture.text + picture.modules + picture.below);
  const auto text = fitted(picture, {.columns = 80, .rows = 12});
  EXPECT_THAT(text, StartsWith(picture.text + "module 0\nmodule 1\n3 of 5 modules are not shown"));
  EXPECT_THAT(text, testing::EndsWith("spark\n"));
  EXPECT_EQ(rowsOf(text), 11U);
  EXPECT_EQ(fitted(picture, {.columns = 80, .rows = 9}), picture.text + picture.below);
}

}  // namespace
}  // namespace rc10::client::screen_fit_test
