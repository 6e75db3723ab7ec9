#include "module/cobs_protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "serial_streams.hpp"
#include "support/heard_cobs.hpp"

namespace rc10::test::cobs_protocol_test {
namespace {

Bytes packed(const Bytes& content) { return HeardCobs::packed(content); }

TEST(CobsProtocol, PacksAsThePaperDoes) {
  // Content 07 00 and its CRC-16/MODBUS (E3 02: 0x02E3, by the sources of the CRC's own test): one zero
  // inside.
  const auto frame = packed({0x07, 0x00});
  ASSERT_EQ(frame.size(), 6U);
  EXPECT_EQ(frame[0], 2);  // the zero is two bytes on
  EXPECT_EQ(frame[1], 0x07);
  EXPECT_EQ(frame[2], 3);
  EXPECT_EQ(frame.back(), 0);
  // "11 22 00 33" of the examples: 03 11 22 02 33 00; two bytes of checksum stand behind it here.
  const auto example = packed({0x11, 0x22, 0x00, 0x33});
  EXPECT_EQ((Bytes{example.begin(), example.begin() + 3}), (Bytes{0x03, 0x11, 0x22}));
  EXPECT_EQ(example[4], 0x33);
}

TEST(CobsProtocol, NoByteOfAFrameButItsLastIsZero) {
  for (std::size_t size = 1; size <= CobsProtocol::kLongestContent; ++size) {
    for (const std::uint8_t fill : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{0xFF}}) {
      const Bytes content(size, fill);
      const auto frame = packed(content);
      ASSERT_EQ(frame.size(), size + 4);
      EXPECT_EQ(std::count(frame.begin(), frame.end(), std::uint8_t{0}), 1);
      EXPECT_EQ(frame.back(), 0);
      HeardCobs protocol;
      feed(protocol, frame);
      ASSERT_EQ(protocol.frames().size(), 1U) << size;
      EXPECT_EQ(protocol.frames()[0], content);
    }
  }
}

TEST(CobsProtocol, RefusesWhatDoesNotFit) {
  EXPECT_TRUE(packed({}).empty());
  EXPECT_TRUE(packed(Bytes(CobsProtocol::kLongestContent + 1, 1)).empty());
  Bytes small(7);
  EXPECT_EQ(HeardCobs{}.pack_frame(Bytes{1, 2, 3, 4}, small), 0U);
}

TEST(CobsProtocol, EverySplitGivesTheSameFrames) {
  const Bytes stream = joined({hex("AA BB 00"), packed({1, 0, 2}), hex("00 00"), packed({3}),
                               Bytes(200, 0x55), hex("00"), packed({4, 5})});
  expectTheSameForEverySplit(stream, HeardCobs::make,
                             [](const HeardCobs& protocol) { return protocol.frames(); });
  HeardCobs protocol;
  feed(protocol, stream);
  EXPECT_EQ(protocol.frames(), (std::vector<Bytes>{{1, 0, 2}, {3}, {4, 5}}));
}

TEST(CobsProtocol, EachWrongByteIsNoticedByTheChecksumOrTheSize) {
  const auto frame = packed({9, 0, 8, 7});
  for (std::size_t at = 0; at < frame.size(); ++at) {
    for (int change = 1; change < 256; ++change) {
      Bytes wrong = frame;
      wrong[at] = static_cast<std::uint8_t>(wrong[at] ^ change);
      HeardCobs protocol;
      feed(protocol, wrong);
      feed(protocol, hex("00"));
      // An end that becomes 1 makes the frame a byte longer, and a CRC goes on over zeros: the size tells.
      for (const auto& heard : protocol.frames()) EXPECT_GT(heard.size(), 4U) << at << " " << change;
    }
  }
}

TEST(CobsProtocol, AFrameThatHadBegunBeforeThePortWasOpenedIsNoError) {
  const auto frame = packed({1, 2, 3});
  const Bytes tail{frame.begin() + 2, frame.end()};
  HeardCobs protocol;
  for (const bool reopened : {false, true}) {
    if (reopened) protocol.restart();
    feed(protocol, tail);
    feed(protocol, frame);
    EXPECT_EQ(protocol.counters().checksum_errors, 0U);
  }
  EXPECT_EQ(protocol.frames(), (std::vector<Bytes>{{1, 2, 3}, {1, 2, 3}}));
  Bytes wrong = frame;
  wrong[1] ^= 0x40U;
  feed(protocol, wrong);
  EXPECT_EQ(protocol.counters().checksum_errors, 1U);
}

TEST(CobsProtocol, ARestartForgetsTheBeginningOfAFrame) {
  const auto frame = packed({1, 2, 3});
  HeardCobs protocol;
  feed(protocol, {frame.begin(), frame.begin() + 3});
  protocol.restart();
  feed(protocol, frame);
  EXPECT_EQ(protocol.frames().size(), 1U);
}

}  // namespace
}  // namespace rc10::test::cobs_protocol_test
