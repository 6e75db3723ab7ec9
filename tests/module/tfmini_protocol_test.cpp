#include "module/tfmini_protocol.hpp"

#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"
#include "module/serial_streams.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::tfmini_protocol_test {
namespace {

using namespace std::chrono_literals;

// Data sheet SJ-PM-TFmini-S, computed independently.
const Bytes k123Centimetres = hex("59 59 7B 00 F4 01 60 09 8B");  // strength 500, 44.0 degC
const Bytes kTooWeak = hex("59 59 FF FF 3C 00 60 09 55");         // strength 60

Bytes measurement(std::uint16_t distance, std::uint16_t strength) {
  auto frame = hex("59 59 00 00 00 00 60 09 00");
  writeLittleEndian(frame, 2, distance);
  writeLittleEndian(frame, 4, strength);
  frame[8] = sum8(std::span(frame).first(8));
  return frame;
}

TEST(TfminiProtocol, DecodesTheGoldenFrame) {
  TfminiProtocol protocol;
  feed(protocol, k123Centimetres, MonotonicTime{4s});
  const auto& range = protocol.range();
  EXPECT_FLOAT_EQ(range.value.distance_m, 1.23F);
  EXPECT_EQ(range.value.strength, 500);
  EXPECT_FLOAT_EQ(range.value.temperature_c, 44.0F);
  EXPECT_TRUE(range.value.valid);
  EXPECT_EQ(range.received, MonotonicTime{4s});
  EXPECT_EQ(protocol.counters().frames, 1U);
}

TEST(TfminiProtocol, MayBeSetToMillimetres) {
  TfminiProtocol protocol{TfminiProtocol::Unit::kMillimetre};
  feed(protocol, k123Centimetres);
  EXPECT_FLOAT_EQ(protocol.range().value.distance_m, 0.123F);
}

TEST(TfminiProtocol, TellsWhatIsNoDistance) {
  TfminiProtocol protocol;
  const auto valid = [&](const Bytes& frame) {
    feed(protocol, frame);
    return protocol.range().value.valid;
  };
  EXPECT_FALSE(valid(kTooWeak));
  EXPECT_FALSE(valid(measurement(100, 99)));
  EXPECT_TRUE(valid(measurement(100, 100)));
  EXPECT_TRUE(valid(measurement(100, 65534)));
  EXPECT_FALSE(valid(measurement(100, 65535)));
  EXPECT_TRUE(valid(measurement(65531, 500)));
  EXPECT_FALSE(valid(measurement(65532, 500)));
  EXPECT_FALSE(valid(measurement(65534, 500)));
  EXPECT_EQ(protocol.counters().frames, 8U) << "an invalid measurement is a frame, and has an age";
}

TEST(TfminiProtocol, AnySingleWrongByteIsNoticed) {
  for (std::size_t i = 0; i < k123Centimetres.size(); ++i) {
    TfminiProtocol protocol;
    auto frame = k123Centimetres;
    frame[i] = static_cast<std::uint8_t>(frame[i] + 1);
    feed(protocol, joined({frame, measurement(250, 300)}));
    EXPECT_EQ(protocol.counters().frames, 1U) << "byte " << i;
    EXPECT_FLOAT_EQ(protocol.range().value.distance_m, 2.5F) << "byte " << i;
  }
}

TEST(TfminiProtocol, HeadersInsideAFrameDoNotConfuseIt) {
  TfminiProtocol protocol;
  feed(protocol, joined({hex("59"), measurement(0x5959, 0x5959), measurement(0x5959, 0x5959)}));
  EXPECT_EQ(protocol.range().samples, 2U);
  EXPECT_EQ(protocol.counters().resync_bytes, 1U);
}

TEST(TfminiProtocol, EverySplitGivesTheSame) {
  const auto stream = joined(
      {noise(9, 1), k123Centimetres, hex("59 59 59"), kTooWeak, noise(20, 2), k123Centimetres, noise(5, 3)});
  expectTheSameForEverySplit(
      stream, [] { return std::make_unique<TfminiProtocol>(); },
      [](const TfminiProtocol& p) { return p.range().samples; });
}

TEST(TfminiProtocol, PacksTheGoldenCommands) {
  struct Case {
    Bytes payload;
    Bytes frame;
  };
  const TfminiProtocol protocol;
  for (const auto& [payload, frame] :
       {Case{{TfminiProtocol::kSetRateHz, 0xE8, 0x03}, hex("5A 06 03 E8 03 4E")},
        Case{{TfminiProtocol::kSetOutput, 0x06}, hex("5A 05 05 06 6A")},
        Case{{TfminiProtocol::kSetBaud, 0x00, 0x10, 0x0E, 0x00}, hex("5A 08 06 00 10 0E 00 86")},
        Case{{TfminiProtocol::kSave}, hex("5A 04 11 6F")},
        Case{{TfminiProtocol::kRestore}, hex("5A 04 10 6E")}}) {
    Bytes out(frame.size());
    EXPECT_EQ(protocol.pack_frame(payload, out), frame.size());
    EXPECT_EQ(out, frame);
    EXPECT_EQ(protocol.pack_frame(payload, std::span(out).first(out.size() - 1)), 0U);
  }
}

TEST(TfminiProtocol, HasNoEmptyAndNoEndlessCommands) {
  const TfminiProtocol protocol;
  Bytes out(64);
  EXPECT_EQ(protocol.pack_frame({}, out), 0U);
  EXPECT_EQ(protocol.pack_frame(Bytes(6), out), 0U);
}

TEST(TfminiProtocol, AllocatesNothing) {
  TfminiProtocol protocol;
  const auto stream = joined({k123Centimetres, noise(50, 4), k123Centimetres});
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) protocol.parse_stream(stream, {});
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GE(protocol.counters().frames, 50U) << "it had work";
}

}  // namespace
}  // namespace rc10::test::tfmini_protocol_test
