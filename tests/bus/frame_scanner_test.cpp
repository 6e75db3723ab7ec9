#include "bus/frame_scanner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace rc10::frame_scanner_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Frames of letters: '<', up to 4 letters, '>'. "<!>" has a wrong checksum, "<->" does not count.
class LetterFrames {
 public:
  void feed(std::string_view text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    scanner.scan(bytes, counters, [this](std::span<const std::uint8_t> shown) { return judge(shown); });
  }

  FrameScanner<6> scanner;
  ProtocolCounters counters;
  std::vector<std::string> frames;

 private:
  ScanVerdict judge(std::span<const std::uint8_t> shown) {
    EXPECT_FALSE(shown.empty());
    EXPECT_LE(shown.size(), 6U);
    const std::string text(shown.begin(), shown.end());
    if (text[0] != '<') return ScanVerdict::kNoise;
    if (text.back() != '>') return ScanVerdict::kMore;
    if (text == "<!>") return ScanVerdict::kBadChecksum;
    if (text == "<->") return ScanVerdict::kSkip;
    frames.push_back(text);
    return ScanVerdict::kFrame;
  }
};

TEST(FrameScanner, FindsFramesInOnePiece) {
  LetterFrames stream;
  stream.feed("<a><bc><defg>");
  EXPECT_THAT(stream.frames, ElementsAre("<a>", "<bc>", "<defg>"));
  EXPECT_EQ(stream.counters.frames, 3U);
  EXPECT_EQ(stream.counters.resync_bytes, 0U);
}

TEST(FrameScanner, AnyCutGivesTheSame) {
  const std::string text = "xy<a>z<bc<de><toolong><!><-><f>";
  LetterFrames whole;
  whole.feed(text);
  EXPECT_THAT(whole.frames, ElementsAre("<a>", "<de>", "<f>"));
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    LetterFrames stream;
    stream.feed(std::string_view(text).substr(0, cut));
    stream.feed(std::string_view(text).substr(cut));
    EXPECT_EQ(stream.frames, whole.frames) << cut;
    EXPECT_EQ(stream.counters.resync_bytes, whole.counters.resync_bytes) << cut;
    EXPECT_EQ(stream.counters.checksum_errors, 1U) << cut;
  }
}

TEST(FrameScanner, AFrameInsideAFalseOneIsFound) {
  LetterFrames stream;
  stream.feed("<abcd<x>");  // the false one is too long at its sixth byte, where the true one has begun
  EXPECT_THAT(stream.frames, ElementsAre("<x>"));
  EXPECT_EQ(stream.counters.resync_bytes, 5U);
}

TEST(FrameScanner, EveryByteIsPartOfAFrameOrCounted) {
  LetterFrames stream;
  stream.feed("..<!>..<->..<ab>..");
  EXPECT_EQ(stream.counters.frames, 1U);
  EXPECT_EQ(stream.counters.checksum_errors, 1U);
  EXPECT_EQ(stream.counters.resync_bytes, 18U - 4U);
  EXPECT_EQ(stream.scanner.pending(), 0U);
}

TEST(FrameScanner, WhatIsForgottenCountsAsNoise) {
  LetterFrames stream;
  stream.feed("<ab");
  EXPECT_EQ(stream.scanner.pending(), 3U);
  stream.scanner.clear(stream.counters);
  stream.feed("c>");
  EXPECT_THAT(stream.frames, IsEmpty());
  EXPECT_EQ(stream.counters.resync_bytes, 5U);
}

}  // namespace
}  // namespace rc10::frame_scanner_test
