#include "survey/frame_words.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "bus/frame_text.hpp"
#include "drives/families.hpp"

// Frames of public documents and captures: those of tests/golden and of the families' golden tests.

namespace rc10::survey::frame_words_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string words(const char* text, std::vector<std::string> models, bool sent = false) {
  const auto frame = parseFrameText(text);
  EXPECT_TRUE(frame) << text;
  return frameWords(frame.value_or(CanFrame{}), models, sent);
}

TEST(FrameWords, DjiFeedbackAndTheCommandOfFour) {
  EXPECT_EQ(words("203#1000F44806662D00", {"M3508"}),
            "DJI 3 feedback: encoder 180 deg, rotor -3000 rpm, current 2 A, temperature 45 °C");
  EXPECT_EQ(words("200#2000F00000004000", {"M3508"}, true), "DJI command of 1 to 4: 10 A, -5 A, 0 A, 20 A");
}

TEST(FrameWords, AFrameOfTwoModelsOfABusIsEither) {
  const auto text = words("206#1FFF12C0FA240000", {"M3508", "GM6020"});
  EXPECT_THAT(text, HasSubstr("DJI 6 feedback"));
  EXPECT_THAT(text, HasSubstr(" or DJI 2 feedback"));
}

TEST(FrameWords, FamiliesThatAreNotOnTheBusSayNothing) {
  EXPECT_EQ(words("203#1000F44806662D00", {"VESC"}), "");
  EXPECT_EQ(words("203#1000F44806662D00", {}), "");
  EXPECT_EQ(words("203#1000F44806662D00", {"no such model"}), "");
}

TEST(FrameWords, AVescSaysItsStatusAndItsCommand) {
  EXPECT_EQ(words("00000968#0000271000640064", {"VESC"}),
            "VESC 104 status 1: velocity 10000 erpm, current 10 A, duty 0.1");
  EXPECT_EQ(words("00000101#00002710", {"VESC"}, true), "VESC 1 command: current 10 A");
}

TEST(FrameWords, RobStrideAndCyberGear) {
  EXPECT_THAT(words("02807FFD#70B987C186650138", {"CyberGear"}),
              StartsWith("RobStride 127 feedback, running: position "));
  EXPECT_THAT(words("02807FFD#70B987C186650138", {"CyberGear"}), HasSubstr("temperature 31.2 °C"));
}

// Any bytes of any frame: words, or none.
TEST(FrameWords, EveryFamilyReadsAnyBytes) {
  std::vector<std::string> models;
  for (const auto& entry : builtInFamilies()) {
    ASSERT_NE(entry.word, nullptr) << entry.family->name();
    for (const auto model : entry.family->models()) models.emplace_back(model);
  }
  std::uint64_t state = 9;
  const auto next = [&state] {
    return static_cast<std::uint32_t>((state = state * 6364136223846793005U + 1) >> 33U);
  };
  for (int i = 0; i < 20'000; ++i) {
    CanFrame frame;
    frame.id = {next() & (i % 2 == 0 ? kStandardIdMask : kExtendedIdMask), i % 2 != 0};
    frame.fd = next() % 4 == 0;
    frame.length = frame.fd ? roundUpFdLength(next() % 65) : static_cast<std::uint8_t>(next() % 9);
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(next());
    for (const bool sent : {false, true}) (void)frameWords(frame, models, sent);
  }
}

}  // namespace
}  // namespace rc10::survey::frame_words_test
