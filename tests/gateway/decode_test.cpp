#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "gateway/convert.hpp"
#include "lcm_messages.hpp"
#include "rc10/event_t.hpp"
#include "rc10/signals_t.hpp"

namespace rc10::gateway::test::decode_test {
namespace {

using rc10::test::Bytes;
using rc10::test::commandWith;
using rc10::test::encoded;
using rc10::test::requestWith;

constexpr std::size_t kClientLength = 8 + 8;  // of command_t and request_t: behind fingerprint and utime

void put32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    bytes.at(at + i) = static_cast<std::byte>(value >> (24U - 8U * static_cast<unsigned>(i)));
}

// Where commandWith() has its setpoint_count.
std::size_t setpointCountAt() { return encoded(commandWith(0)).size() - 4; }

Defect decodeCommand(const Bytes& bytes) {
  link::Command command;
  return decode(bytes, command);
}

TEST(DecodeCommand, HasEveryField) {
  link::Command command;
  ASSERT_EQ(decode(encoded(commandWith(3)), command), Defect::kNone);
  EXPECT_EQ(command.client.view(), "teleop");
  EXPECT_EQ(static_cast<std::int64_t>(command.session), -1234567890123456789);
  EXPECT_EQ(command.seq, 42);
  EXPECT_EQ(command.priority, -3);
  EXPECT_EQ(command.validity_ms, 80);
  ASSERT_EQ(command.setpoint_count, 3U);
  const auto& last = command.setpoints[2];
  EXPECT_EQ(last.motor.view(), "motor_2");
  EXPECT_EQ(last.target.mode, ControlMode::kVelocity);
  EXPECT_EQ(last.target.value, 21.0);
  EXPECT_EQ(last.target.velocity_ff_rpm, 1.25F);
  EXPECT_EQ(last.target.torque_ff_nm, -0.5F);
  EXPECT_EQ(last.target.stiffness_nm_per_rad, 3.5F);
  EXPECT_EQ(last.target.damping_nms_per_rad, 0.125F);
}

TEST(DecodeCommand, LeavesTheReceiveTimeAlone) {
  link::Command command;
  command.received_ns = 99;
  ASSERT_EQ(decode(encoded(commandWith(1)), command), Defect::kNone);
  EXPECT_EQ(command.received_ns, 99);
}

TEST(DecodeCommand, TakesAsManySetpointsAsThereMayBe) {
  auto largest = commandWith(static_cast<int>(link::kMaxMotors));
  for (auto& setpoint : largest.setpoints) setpoint.motor.assign(31, 'm');
  largest.client.assign(31, 'c');
  const auto bytes = encoded(largest);
  EXPECT_LE(bytes.size(), kMaxIncoming);
  link::Command command;
  ASSERT_EQ(decode(bytes, command), Defect::kNone);
  EXPECT_EQ(command.setpoint_count, link::kMaxMotors);
  EXPECT_EQ(decodeCommand(encoded(commandWith(0))), Defect::kNone) << "rc10d judges whether none is enough";
}

TEST(DecodeCommand, LetsNumbersThroughBitByBit) {
  auto original = commandWith(1);
  const auto nan = std::bit_cast<double>(0x7FF8DEADBEEF0001ULL);
  original.setpoints[0].value = nan;
  original.setpoints[0].torque_ff_nm = std::numeric_limits<float>::infinity();
  original.setpoints[0].velocity_ff_rpm = std::bit_cast<float>(0x7FC12345U);
  original.setpoints[0].mode = -1;
  link::Command command;
  ASSERT_EQ(decode(encoded(original), command), Defect::kNone);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(command.setpoints[0].target.value), 0x7FF8DEADBEEF0001ULL);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(command.setpoints[0].target.velocity_ff_rpm), 0x7FC12345U);
  EXPECT_TRUE(std::isinf(command.setpoints[0].target.torque_ff_nm));
  EXPECT_EQ(command.setpoints[0].target.mode, ControlMode{255}) << "no mode: rc10d refuses it";
}

TEST(DecodeSignals, HasEveryField) {
  signals_t original{};
  original.utime = 11;
  original.mono_us = 0x0102030405060708;
  original.client = "pad";
  original.session = 12;
  original.seq = 13;
  original.priority = 14;
  original.validity_ms = 15;
  original.count = 2;
  original.names = {"vx_m_s", "wz_rad_s"};
  original.values = {0.5, -1.5};
  link::Signals signals;
  ASSERT_EQ(decode(encoded(original), signals), Defect::kNone);
  EXPECT_EQ(signals.client.view(), "pad");
  EXPECT_EQ(signals.session, 12U);
  EXPECT_EQ(signals.seq, 13);
  EXPECT_EQ(signals.priority, 14);
  EXPECT_EQ(signals.validity_ms, 15);
  ASSERT_EQ(signals.value_count, 2U);
  EXPECT_EQ(signals.values[0].name.view(), "vx_m_s");
  EXPECT_EQ(signals.values[1].name.view(), "wz_rad_s");
  EXPECT_EQ(signals.values[0].value, 0.5);
  EXPECT_EQ(signals.values[1].value, -1.5);
}

TEST(DecodeCommand, OfOtherDefinitionsIsToldFromOtherDefects) {
  signals_t signals{};
  EXPECT_EQ(decodeCommand(encoded(signals)), Defect::kOtherDefinitions);
  auto bytes = encoded(commandWith(1));
  bytes[7] ^= std::byte{1};
  EXPECT_EQ(decodeCommand(bytes), Defect::kOtherDefinitions);
  link::Request request;
  const auto [defect, identified, forgiven] = decode(encoded(commandWith(1)), request);
  EXPECT_EQ(defect, Defect::kOtherDefinitions);
  EXPECT_FALSE(identified);
}

TEST(DecodeCommand, CutOffAnywhereIsRefused) {
  const auto bytes = encoded(commandWith(3));
  link::Command command;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode(std::span{bytes}.first(size), command), Defect::kTruncated) << size;
  }
}

TEST(DecodeCommand, WithBytesBehindItsEndIsRefused) {
  auto bytes = encoded(commandWith(2));
  bytes.push_back(std::byte{0});
  EXPECT_EQ(decodeCommand(bytes), Defect::kTrailingBytes);
}

TEST(DecodeCommand, WithACountThatLiesIsRefused) {
  const auto original = encoded(commandWith(2));
  const struct {
    std::uint32_t count;
    Defect defect;
  } cases[] = {{0, Defect::kTrailingBytes},     {1, Defect::kTrailingBytes},
               {3, Defect::kTruncated},         {128, Defect::kTruncated},
               {129, Defect::kTooMany},         {0x7FFFFFFF, Defect::kTooMany},
               {0x80000000, Defect::kBadCount}, {0xFFFFFFFF, Defect::kBadCount}};
  for (const auto& [count, defect] : cases) {
    auto bytes = original;
    put32(bytes, setpointCountAt(), count);
    EXPECT_EQ(decodeCommand(bytes), defect) << count;
  }
}

TEST(DecodeCommand, WithAStringLengthThatLiesIsRefused) {
  const auto original = encoded(commandWith(1));
  const struct {
    std::uint32_t length;
    Defect defect;
  } cases[] = {{0, Defect::kBadText},          {1, Defect::kBadText},
               {6, Defect::kBadText},          {8, Defect::kBadText},
               {5000, Defect::kTruncated},     {0x7FFFFFFF, Defect::kTruncated},
               {0x80000000, Defect::kBadText}, {0xFFFFFFFF, Defect::kBadText}};
  for (const auto& [length, defect] : cases) {
    auto bytes = original;
    put32(bytes, kClientLength, length);
    EXPECT_EQ(decodeCommand(bytes), defect) << length;
  }
}

TEST(DecodeCommand, WithAZeroInsideAStringIsRefused) {
  auto bytes = encoded(commandWith(1));
  bytes[kClientLength + 4 + 2] = std::byte{0};
  EXPECT_EQ(decodeCommand(bytes), Defect::kBadText);
}

TEST(DecodeCommand, NeverCutsANameOff) {
  // "front_left_..." cut off could be the name of another motor.
  auto original = commandWith(1);
  original.setpoints[0].motor.assign(32, 'm');
  EXPECT_EQ(decodeCommand(encoded(original)), Defect::kTextTooLong);
  original = commandWith(1);
  original.client.assign(32, 'c');
  EXPECT_EQ(decodeCommand(encoded(original)), Defect::kTextTooLong);
  original.client.assign(31, 'c');
  EXPECT_EQ(decodeCommand(encoded(original)), Defect::kNone);
}

TEST(DecodeCommand, LargerThanAnyIsRefused) {
  EXPECT_EQ(decodeCommand(Bytes(kMaxIncoming + 1)), Defect::kTooLarge);
  auto bytes = encoded(commandWith(1));
  bytes.resize(kMaxIncoming + 1);
  EXPECT_EQ(decodeCommand(bytes), Defect::kTooLarge);
}

TEST(DecodeRequest, HasEveryField) {
  link::Request request;
  const auto [defect, identified, forgiven] = decode(encoded(requestWith(2)), request);
  ASSERT_EQ(defect, Defect::kNone);
  EXPECT_TRUE(identified);
  EXPECT_EQ(request.client.view(), "teleop");
  EXPECT_EQ(request.session, 77U);
  EXPECT_EQ(request.seq, 5);
  EXPECT_EQ(request.operation.view(), "zero");
  EXPECT_EQ(request.target.view(), "yaw,pitch");
  ASSERT_EQ(request.value_count, 2U);
  EXPECT_EQ(request.values[1].name.view(), "value_1");
  EXPECT_EQ(request.values[1].value, -0.5);
}

TEST(DecodeRequest, TakesTheLargest) {
  auto largest = requestWith(static_cast<int>(link::kMaxValues));
  largest.target.assign(1023, 't');
  for (auto& value : largest.values) value.name.assign(47, 'n');
  link::Request request;
  EXPECT_EQ(decode(encoded(largest), request).defect, Defect::kNone);
  EXPECT_EQ(decode(encoded(requestWith(17)), request).defect, Defect::kTooMany);
}

TEST(DecodeRequest, IsIdentifiedAsSoonAsItsSenderIsKnown) {
  auto original = requestWith(1);
  original.target.assign(1024, 't');
  link::Request request;
  const auto decoding = decode(encoded(original), request);
  EXPECT_EQ(decoding.defect, Defect::kTextTooLong);
  EXPECT_TRUE(decoding.identified);
  EXPECT_EQ(request.session, 77U);
  EXPECT_EQ(request.seq, 5);

  original = requestWith(1);
  original.client.assign(32, 'c');
  EXPECT_FALSE(decode(encoded(original), request).identified);
}

TEST(DecodeRequest, AnEstopIsOneWhateverElseItsMessageSays) {
  const auto isEstop = [](const std::vector<std::byte>& bytes) {
    link::Request request;
    request.target = "of the message before";
    const auto [defect, identified, forgiven] = decode(bytes, request);
    return defect == Defect::kNone && identified && request.operation.view() == "estop" &&
           (forgiven == Defect::kNone || (request.target.view().empty() && request.value_count == 0));
  };
  auto plain = requestWith(0);
  plain.operation = "estop";
  EXPECT_TRUE(isEstop(encoded(plain)));
  auto long_name = plain;
  long_name.client = std::string(500, 'n');
  EXPECT_TRUE(isEstop(encoded(long_name)));
  auto long_target = plain;
  long_target.target = std::string(20'000, 't');
  EXPECT_TRUE(isEstop(encoded(long_target)));
  auto values = requestWith(17);
  values.operation = "estop";
  EXPECT_TRUE(isEstop(encoded(values)));
  auto trailing = encoded(plain);
  trailing.resize(trailing.size() + 40);
  EXPECT_TRUE(isEstop(trailing));
  auto cut = encoded(plain);
  const std::size_t after_operation = 8 + 8 + 4 + plain.client.size() + 1 + 8 + 8 + 4 + 6;
  for (std::size_t size = after_operation; size < encoded(plain).size(); ++size) {
    cut.resize(size);
    EXPECT_TRUE(isEstop(cut)) << size;
    cut = encoded(plain);
  }
  cut.resize(after_operation - 1);
  EXPECT_FALSE(isEstop(cut)) << "\"estop\" may go on";
  auto other = plain;
  other.operation = "estopped";
  other.client = std::string(500, 'n');
  EXPECT_FALSE(isEstop(encoded(other)));
}

TEST(DecodeRequest, AnEstopOfALongNameIsOfAsMuchOfItAsThereIsRoomFor) {
  auto long_name = requestWith(0);
  long_name.operation = "estop";
  long_name.client = std::string(31, 'n') + "xyz";
  link::Request request;
  EXPECT_EQ(decode(encoded(long_name), request).forgiven, Defect::kTextTooLong);
  EXPECT_EQ(request.client.view(), std::string(31, 'n'));
  EXPECT_EQ(request.session, 77U);
  EXPECT_EQ(request.seq, 5);
}

TEST(DecodeRequest, CutOffAnywhereIsRefused) {
  const auto bytes = encoded(requestWith(2));
  link::Request request;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode(std::span{bytes}.first(size), request).defect, Defect::kTruncated) << size;
  }
}

// Whatever is accepted is within bounds and says the same as lcm-gen's own decoder.
void expectSameAsLcmGen(const Bytes& bytes) {
  link::Command command;
  if (decode(bytes, command) != Defect::kNone) return;
  ASSERT_LE(command.setpoint_count, link::kMaxMotors);
  command_t reference{};
  ASSERT_EQ(reference.decode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  EXPECT_EQ(command.client.view(), reference.client);
  EXPECT_EQ(command.seq, reference.seq);
  ASSERT_EQ(command.setpoint_count, reference.setpoints.size());
  for (std::size_t i = 0; i < command.setpoint_count; ++i) {
    EXPECT_EQ(command.setpoints[i].motor.view(), reference.setpoints[i].motor);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(command.setpoints[i].target.value),
              std::bit_cast<std::uint64_t>(reference.setpoints[i].value));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(command.setpoints[i].target.damping_nms_per_rad),
              std::bit_cast<std::uint32_t>(reference.setpoints[i].damping_nms_per_rad));
  }
}

TEST(DecodeProperty, ChangedCommandsAreRefusedOrMeanWhatLcmSays) {
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same cases in every run
  for (int round = 0; round < 20'000; ++round) {
    auto bytes = encoded(commandWith(static_cast<int>(random() % 5)));
    for (unsigned changes = random() % 4; changes > 0; --changes) {
      bytes[8 + random() % (bytes.size() - 8)] = static_cast<std::byte>(random() % 3 == 0 ? 0U : random());
    }
    if (round % 5 == 0) bytes.resize(random() % (bytes.size() + 8));
    expectSameAsLcmGen(bytes);
  }
}

TEST(DecodeProperty, RandomBytesBehindTheRightFingerprintAreHarmless) {
  std::mt19937 random(2);  // NOLINT(cert-msc51-cpp)
  const auto command_start = encoded(commandWith(0));
  const auto request_start = encoded(requestWith(0));
  for (int round = 0; round < 20'000; ++round) {
    const auto& start = round % 2 == 0 ? command_start : request_start;
    Bytes bytes(start.begin(), start.begin() + 8);
    bytes.resize(8 + random() % 600);
    for (std::size_t i = 8; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::byte>(random() % 2 == 0 ? 0U : random());
    expectSameAsLcmGen(bytes);
    link::Request request;
    if (decode(bytes, request).defect == Defect::kNone) {
      EXPECT_LE(request.value_count, link::kMaxValues);
    }
  }
}

TEST(Defect, HasWords) {
  for (int i = 0; i < 12; ++i) EXPECT_NE(inWords(static_cast<Defect>(i)), nullptr);
}

}  // namespace
}  // namespace rc10::gateway::test::decode_test
