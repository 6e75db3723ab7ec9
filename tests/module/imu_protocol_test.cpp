#include <gtest/gtest.h>

#include <limits>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"
#include "module/hipnuc_protocol.hpp"
#include "module/serial_streams.hpp"
#include "module/witmotion_protocol.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::imu_protocol_test {
namespace {

using namespace std::chrono_literals;

// The example frame of HiPNUC's user manual, with its values.
const Bytes kHipnuc =
    hex("5A A5 4C 00 6C 51 91 00 A0 3B 01 A8 02 97 BD BB 04 00 9C A0 65 3E A2 26 45 3F 5C E7 30 3F E2 D4 5A "
        "C2 E5 9D "
        "A0 C1 EB 23 EE C2 78 77 99 41 AB AA D1 C1 AB 2A 0A C2 8D E1 42 42 8F 1D A8 C1 1E 0C 36 C2 E6 E5 5A "
        "3F C1 94 "
        "9E 3E B8 C0 9E BE BE DF 8D BE");

// Scalings as published by WitMotion, bytes computed independently.
const Bytes kWitAcceleration = hex("55 51 00 08 00 FC 00 02 00 00 AC");  // 1, -0.5, 0.25 g
const Bytes kWitRates = hex("55 52 00 C0 00 20 64 00 00 00 EB");         // -1000, 500, 6.1035 deg/s
const Bytes kWitAngles = hex("55 53 00 40 00 E0 00 80 00 00 48");        // 90, -45, -180 deg
const Bytes kWitQuaternion = hex("55 59 FF 7F 00 00 00 C0 00 00 EC");    // 1, 0, -0.5, 0
const Bytes kWitMagnetic = hex("55 54 01 00 02 00 03 00 04 00 B3");

/// A HiPNUC frame around `payload`.
Bytes hipnucFrame(const Bytes& payload) {
  Bytes frame = hex("5A A5 00 00 00 00");
  writeLittleEndian(frame, 2, static_cast<std::uint16_t>(payload.size()));
  const auto crc = crc16Xmodem(payload, crc16Xmodem(std::span(frame).first(4)));
  writeLittleEndian(frame, 4, crc);
  return joined({frame, payload});
}

TEST(HipnucProtocol, DecodesTheManualsExample) {
  HipnucProtocol protocol;
  const MonotonicTime at{3s};
  feed(protocol, kHipnuc, at);
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.counters().resync_bytes, 0U);
  EXPECT_NEAR(protocol.acceleration().value.x_m_s2, 0.224245F * 9.80665F, 1e-4F);
  EXPECT_NEAR(protocol.acceleration().value.z_m_s2, 0.691030F * 9.80665F, 1e-4F);
  EXPECT_NEAR(protocol.rates().value.x_deg_s, -54.7079F, 1e-3F);
  EXPECT_NEAR(protocol.rates().value.z_deg_s, -119.0702F, 1e-3F);
  EXPECT_NEAR(protocol.angles().value.roll_deg, 48.7203F, 1e-3F);
  EXPECT_NEAR(protocol.angles().value.pitch_deg, -21.0144F, 1e-3F);
  EXPECT_NEAR(protocol.angles().value.yaw_deg, -45.5118F, 1e-3F);
  EXPECT_NEAR(protocol.quaternion().value[0], 0.85507F, 1e-4F);
  EXPECT_NEAR(protocol.quaternion().value[3], -0.27710F, 1e-4F);
  EXPECT_EQ(protocol.angles().received, at);
  EXPECT_EQ(protocol.angles().age(at + 10ms), 10ms);
}

TEST(HipnucProtocol, AnySingleWrongByteIsNoticed) {
  for (std::size_t i = 0; i < kHipnuc.size(); ++i) {
    HipnucProtocol protocol;
    auto frame = kHipnuc;
    frame[i] = static_cast<std::uint8_t>(frame[i] ^ 0x20U);
    feed(protocol, joined({frame, kHipnuc, kHipnuc, kHipnuc, kHipnuc}));
    EXPECT_EQ(protocol.counters().frames, 4U) << "byte " << i;
  }
}

TEST(HipnucProtocol, OtherPacketsCountAndBringNoValues) {
  HipnucProtocol protocol;
  feed(protocol, hipnucFrame(Bytes(48, 0x92)));
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.angles().samples, 0U);
}

TEST(HipnucProtocol, APacketThatIsTooShortBringsNoValues) {
  HipnucProtocol protocol;
  const Bytes packet(kHipnuc.begin() + 6, kHipnuc.end() - 1);
  feed(protocol, hipnucFrame(packet));
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.angles().samples, 0U);
}

TEST(HipnucProtocol, WhatIsNoNumberIsNoValue) {
  for (std::size_t at = 12; at < 76; at += 4) {
    HipnucProtocol protocol;
    Bytes packet(kHipnuc.begin() + 6, kHipnuc.end());
    writeLittleEndian(packet, at, std::numeric_limits<float>::quiet_NaN());
    feed(protocol, hipnucFrame(packet));
    EXPECT_EQ(protocol.counters().frames, 1U);
    EXPECT_EQ(protocol.angles().samples, 0U) << at;
  }
}

TEST(HipnucProtocol, ALengthBeyondAllFramesIsNoise) {
  HipnucProtocol protocol;
  feed(protocol, joined({hex("5A A5 FF FF 00 00"), hex("5A A5 00 00 00 00"), kHipnuc}));
  EXPECT_EQ(protocol.counters().frames, 1U);
  EXPECT_EQ(protocol.counters().resync_bytes, 12U);
}

TEST(HipnucProtocol, EverySplitGivesTheSame) {
  const auto stream = joined({noise(9, 1), kHipnuc, hex("5A A5 5A"), kHipnuc, noise(20, 2), kHipnuc});
  expectTheSameForEverySplit(
      stream, [] { return std::make_unique<HipnucProtocol>(); },
      [](const HipnucProtocol& p) { return p.angles().samples; });
}

TEST(HipnucProtocol, SendsLinesOfText) {
  const HipnucProtocol protocol;
  const std::string command = "LOG VERSION";
  const Bytes payload(command.begin(), command.end());
  Bytes out(13);
  ASSERT_EQ(protocol.pack_frame(payload, out), 13U);
  EXPECT_EQ(std::string(out.begin(), out.end()), "LOG VERSION\r\n");
  out.resize(12);
  EXPECT_EQ(protocol.pack_frame(payload, out), 0U);
  EXPECT_EQ(protocol.pack_frame({}, out), 0U);
}

TEST(WitMotionProtocol, DecodesEachQuantity) {
  WitMotionProtocol protocol;
  const MonotonicTime at{2s};
  feed(protocol, joined({kWitAcceleration, kWitRates, kWitAngles, kWitQuaternion, kWitMagnetic}), at);
  EXPECT_EQ(protocol.counters().frames, 5U);
  EXPECT_FLOAT_EQ(protocol.acceleration().value.x_m_s2, 9.80665F);
  EXPECT_FLOAT_EQ(protocol.acceleration().value.y_m_s2, -0.5F * 9.80665F);
  EXPECT_FLOAT_EQ(protocol.acceleration().value.z_m_s2, 0.25F * 9.80665F);
  EXPECT_FLOAT_EQ(protocol.rates().value.x_deg_s, -1000.0F);
  EXPECT_FLOAT_EQ(protocol.rates().value.y_deg_s, 500.0F);
  EXPECT_NEAR(protocol.rates().value.z_deg_s, 6.1035F, 1e-3F);
  EXPECT_FLOAT_EQ(protocol.angles().value.roll_deg, 90.0F);
  EXPECT_FLOAT_EQ(protocol.angles().value.pitch_deg, -45.0F);
  EXPECT_FLOAT_EQ(protocol.angles().value.yaw_deg, -180.0F);
  EXPECT_NEAR(protocol.quaternion().value[0], 1.0F, 1e-4F);
  EXPECT_FLOAT_EQ(protocol.quaternion().value[2], -0.5F);
  EXPECT_EQ(protocol.angles().received, at);
}

TEST(WitMotionProtocol, EachQuantityHasAnAgeOfItsOwn) {
  WitMotionProtocol protocol;
  feed(protocol, kWitAngles, MonotonicTime{1s});
  feed(protocol, kWitRates, MonotonicTime{2s});
  EXPECT_EQ(protocol.angles().age(MonotonicTime{3s}), 2s);
  EXPECT_EQ(protocol.rates().age(MonotonicTime{3s}), 1s);
  EXPECT_EQ(protocol.quaternion().age(MonotonicTime{3s}), Duration::max());
}

TEST(WitMotionProtocol, AnySingleWrongByteIsNoticed) {
  for (std::size_t i = 0; i < kWitAngles.size(); ++i) {
    WitMotionProtocol protocol;
    auto frame = kWitAngles;
    frame[i] = static_cast<std::uint8_t>(frame[i] ^ 0x20U);
    feed(protocol, joined({frame, kWitAngles}));
    EXPECT_EQ(protocol.counters().frames, 1U) << "byte " << i;
    EXPECT_EQ(protocol.counters().resync_bytes, 11U) << "byte " << i;
  }
}

TEST(WitMotionProtocol, EverySplitGivesTheSame) {
  const auto stream =
      joined({noise(9, 3), kWitAcceleration, hex("55 55 53"), kWitAngles, noise(20, 4), kWitRates});
  expectTheSameForEverySplit(
      stream, [] { return std::make_unique<WitMotionProtocol>(); },
      [](const WitMotionProtocol& p) { return p.angles().samples + 10 * p.rates().samples; });
}

TEST(WitMotionProtocol, WritesRegisters) {
  const WitMotionProtocol protocol;
  Bytes out(8);
  ASSERT_EQ(protocol.pack_frame(hex("03 09 00"), out), 5U);  // output rate: 100 Hz
  EXPECT_EQ(Bytes(out.begin(), out.begin() + 5), hex("FF AA 03 09 00"));
  EXPECT_EQ(protocol.pack_frame(hex("03 09"), out), 0U);
  EXPECT_EQ(protocol.pack_frame(hex("03 09 00"), std::span(out).first(4)), 0U);
}

TEST(ImuProtocols, AllocateNothing) {
  HipnucProtocol hipnuc;
  WitMotionProtocol witmotion;
  const auto stream = joined({kHipnuc, kWitAngles, noise(300, 5)});
  const AllocGuard guard;
  for (int i = 0; i < 20; ++i) {
    hipnuc.parse_stream(stream, {});
    witmotion.parse_stream(stream, {});
  }
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GE(hipnuc.counters().frames, 20U) << "it had work";
  EXPECT_GE(witmotion.counters().frames, 20U) << "it had work";
}

}  // namespace
}  // namespace rc10::test::imu_protocol_test
