// The worked example of docs/serial-devices.md.
#include "module/text_protocol.hpp"

#include <gtest/gtest.h>

#include "module/serial_streams.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::text_protocol_test {
namespace {

using namespace std::chrono_literals;

Bytes text(std::string_view letters) { return {letters.begin(), letters.end()}; }

// "range,1.25,-0.5": the exclusive or was computed independently.
const Bytes kGolden = text("$range,1.25,-0.5*61\n");

Bytes packed(std::string_view content) {
  const TextProtocol protocol;
  Bytes out(TextProtocol::kLongestLine);
  out.resize(protocol.pack_frame(text(content), out));
  return out;
}

TEST(TextProtocol, DecodesALine) {
  TextProtocol protocol;
  feed(protocol, kGolden, MonotonicTime{5s});
  const auto& message = protocol.message();
  EXPECT_EQ(message.value.name(), "range");
  ASSERT_EQ(message.value.value_count, 2U);
  EXPECT_EQ(message.value.values[0], 1.25);
  EXPECT_EQ(message.value.values[1], -0.5);
  EXPECT_EQ(message.received, MonotonicTime{5s});
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.counters().resync_bytes, 0U);
}

TEST(TextProtocol, PacksALine) { EXPECT_EQ(packed("range,1.25,-0.5"), kGolden); }

TEST(TextProtocol, WhatIsPackedIsDecoded) {
  for (const char* content : {"a", "A_9,0", "x,1,2,3,4,5,6,7,8", "name_of_15_char,-.5,7.,123456789012345"}) {
    TextProtocol protocol;
    feed(protocol, packed(content));
    EXPECT_EQ(protocol.counters().frames, 1U) << content;
  }
}

TEST(TextProtocol, AllowsACarriageReturn) {
  TextProtocol protocol;
  feed(protocol, text("$range,1.25,-0.5*61\r\n"));
  EXPECT_EQ(protocol.counters().frames, 1U);
}

TEST(TextProtocol, ALineOfAnotherMakeIsNoise) {
  for (const char* content : {"", ",1", "a b,1", "a,", "a,1,", "a,x", "a,1.2.3", "a,1e3", "a,--1", "a,-",
                              "a,.", "x,1,2,3,4,5,6,7,8,9", "a_name_16_letters,1", "a,1234567890123456"}) {
    TextProtocol protocol;
    const auto line = packed(content);
    feed(protocol, line.empty() ? text("$*00\n") : line);
    EXPECT_EQ(protocol.counters().frames, 0U) << content;
    EXPECT_EQ(protocol.counters().checksum_errors, 0U) << content;
    feed(protocol, kGolden);
    EXPECT_EQ(protocol.counters().frames, 1U) << content;
  }
}

TEST(TextProtocol, AnySingleWrongByteIsNoticed) {
  for (std::size_t i = 0; i < kGolden.size(); ++i) {
    TextProtocol protocol;
    auto line = kGolden;
    line[i] = static_cast<std::uint8_t>(line[i] ^ 1U);
    feed(protocol, joined({line, text("\n"), packed("next,1")}));
    EXPECT_EQ(protocol.counters().frames, 1U) << i;
    EXPECT_EQ(protocol.message().value.name(), "next") << i;
  }
}

TEST(TextProtocol, TheChecksumIsTwoCapitalHexadecimalDigits) {
  for (const char* line : {"$a,1*g0\n", "$a,1*7:\n", "$a,1*7\n", "$a,1*\n", "$a,1\n", "$\n", "\n"}) {
    TextProtocol protocol;
    feed(protocol, text(line));
    EXPECT_EQ(protocol.counters().frames, 0U) << line;
    EXPECT_EQ(protocol.counters().resync_bytes, std::string_view(line).size()) << line;
  }
}

TEST(TextProtocol, ALineWithoutAnEndIsGivenUp) {
  TextProtocol protocol;
  feed(protocol, text("$" + std::string(500, 'a')));
  feed(protocol, kGolden);
  EXPECT_EQ(protocol.counters().frames, 1U);
}

TEST(TextProtocol, EverySplitGivesTheSame) {
  const auto stream =
      joined({noise(9, 1), kGolden, text("$ra"), kGolden, text("$range,1*00\n"), noise(150, 2), kGolden});
  expectTheSameForEverySplit(
      stream, [] { return std::make_unique<TextProtocol>(); },
      [](const TextProtocol& p) { return p.message().samples; });
}

TEST(TextProtocol, DoesNotPackWhatItCouldNotRead) {
  for (const std::string content : {"", "a$b", "a*b", "a\nb", "a\x80", "a\r"})
    EXPECT_TRUE(packed(content).empty());
  EXPECT_EQ(packed(std::string(115, 'a')).size(), TextProtocol::kLongestLine);
  EXPECT_TRUE(packed(std::string(116, 'a')).empty());
  const TextProtocol protocol;
  Bytes out(5);
  EXPECT_EQ(protocol.pack_frame(text("a"), out), 0U);
}

TEST(TextProtocol, AllocatesNothing) {
  TextProtocol protocol;
  const auto stream = joined({kGolden, noise(50, 3), kGolden});
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) protocol.parse_stream(stream, {});
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GE(protocol.counters().frames, 50U) << "it had work";
}

}  // namespace
}  // namespace rc10::test::text_protocol_test
