#include "module/modbus_rtu.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "module/checksums.hpp"
#include "module/serial_streams.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::modbus_rtu_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr auto kTimeout = 50ms;
const ModbusRequest kTwoRegisters{
    .address = 1, .function = ModbusFunction::kReadHolding, .first = 0, .count = 2};
const Bytes kAnswer3000 = hex("01 03 04 00 00 0B B8 FD 71");  // A long of 3000; its CRC by libmodbus.

/// With its checksum.
Bytes frame(const std::string& text) {
  auto bytes = hex(text);
  const auto crc = crc16Modbus(bytes);
  bytes.push_back(static_cast<std::uint8_t>(crc));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return bytes;
}

class ModbusRtuTest : public ::testing::Test {
 protected:
  Bytes begin(const ModbusRequest& request) {
    Bytes out(ModbusRtu::kLongestFrame);
    out.resize(modbus.begin(request, now, kTimeout, out));
    return out;
  }
  void answer(const Bytes& bytes) { feed(modbus, bytes, now += 2ms); }

  MonotonicTime now{1000s};
  ModbusRtu modbus;
};

TEST_F(ModbusRtuTest, AsksWithTheGoldenFrames) {
  struct Case {
    ModbusRequest request;
    const char* frame;
  };
  const std::array<std::uint16_t, 1> value{255};
  for (const auto& [request, expected] :
       {Case{{.address = 1, .first = 0, .count = 10}, "01 03 00 00 00 0A C5 CD"},
        Case{{.address = 1, .function = ModbusFunction::kWriteSingle, .first = 1, .values = value},
             "01 06 00 01 00 FF 98 4A"},
        Case{{.address = 0x50, .first = 0x34, .count = 1}, "50 03 00 34 00 01 C8 45"},
        Case{{.address = 1, .first = 0x0F, .count = 2}, "01 03 00 0F 00 02 F4 08"}}) {
    modbus.update(now += kTimeout);
    EXPECT_EQ(begin(request), hex(expected));
    EXPECT_EQ(modbus.state(), ModbusState::kWaiting);
  }
}

TEST_F(ModbusRtuTest, WritesSeveralRegisters) {
  const std::array<std::uint16_t, 2> values{0x000A, 0x0102};
  const ModbusRequest request{
      .address = 17, .function = ModbusFunction::kWriteMultiple, .first = 1, .values = values};
  // The example of the Modbus application protocol, function 16.
  EXPECT_EQ(begin(request), frame("11 10 00 01 00 02 04 00 0A 01 02"));
  answer(frame("11 10 00 01 00 02"));
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
  EXPECT_THAT(modbus.values(), IsEmpty());
}

TEST_F(ModbusRtuTest, ReadsTheGoldenAnswer) {
  EXPECT_EQ(modbus.state(), ModbusState::kIdle);
  (void)begin(kTwoRegisters);
  answer(kAnswer3000);
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
  EXPECT_THAT(modbus.values(), ElementsAre(0, 3000));
  EXPECT_EQ(modbus.answered(), now);
  EXPECT_EQ(modbus.modbusCounters().answers, 1U);
  EXPECT_EQ(modbus.counters().frames, 1U);
}

TEST_F(ModbusRtuTest, ReadsInputRegistersAndAsManyAsFit) {
  (void)begin({.address = 2, .function = ModbusFunction::kReadInput, .first = 7, .count = 125});
  std::string text = "02 04 FA";
  for (int i = 0; i < 125; ++i) text += " 01 02";
  answer(frame(text));
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
  EXPECT_EQ(modbus.values().size(), 125U);
  EXPECT_EQ(modbus.values()[124], 0x0102);
}

TEST_F(ModbusRtuTest, AWriteIsAnsweredByItself) {
  const std::array<std::uint16_t, 1> value{255};
  const auto asked =
      begin({.address = 1, .function = ModbusFunction::kWriteSingle, .first = 1, .values = value});
  auto other = frame("01 06 00 02 00 FF");
  answer(other);
  EXPECT_EQ(modbus.state(), ModbusState::kWaiting) << "another register";
  answer(asked);
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
}

TEST_F(ModbusRtuTest, AnExceptionHasItsCode) {
  (void)begin(kTwoRegisters);
  answer(hex("01 83 02 C0 F1"));
  EXPECT_EQ(modbus.state(), ModbusState::kException);
  EXPECT_EQ(modbus.exceptionCode(), 2);
  EXPECT_EQ(modbus.modbusCounters().exceptions, 1U);
}

TEST_F(ModbusRtuTest, WithoutAnAnswerTheQuestionIsGivenUp) {
  (void)begin(kTwoRegisters);
  modbus.update(now + kTimeout - 1ns);
  EXPECT_EQ(modbus.state(), ModbusState::kWaiting);
  modbus.update(now + kTimeout);
  EXPECT_EQ(modbus.state(), ModbusState::kTimedOut);
  EXPECT_EQ(modbus.modbusCounters().timeouts, 1U);
  answer(kAnswer3000);
  EXPECT_EQ(modbus.state(), ModbusState::kTimedOut) << "too late";
  EXPECT_EQ(modbus.counters().resync_bytes, kAnswer3000.size());
}

TEST_F(ModbusRtuTest, OneQuestionIsUnderWayAtATime) {
  (void)begin(kTwoRegisters);
  EXPECT_THAT(begin(kTwoRegisters), IsEmpty());
  answer(kAnswer3000);
  EXPECT_THAT(begin(kTwoRegisters), IsEmpty()) << "the line was not silent for a frame gap";
  now += 1749us;
  EXPECT_THAT(begin(kTwoRegisters), IsEmpty());
  now += 1us;
  EXPECT_EQ(begin(kTwoRegisters).size(), 8U);
  EXPECT_EQ(modbus.modbusCounters().requests, 2U);
}

TEST_F(ModbusRtuTest, WhatIsReadStaysUntilTheNextRead) {
  (void)begin(kTwoRegisters);
  answer(kAnswer3000);
  now += 10ms;
  (void)begin(kTwoRegisters);
  modbus.update(now += kTimeout);
  EXPECT_THAT(modbus.values(), ElementsAre(0, 3000));
  EXPECT_EQ(modbus.state(), ModbusState::kTimedOut);
}

TEST_F(ModbusRtuTest, AWrongChecksumIsNoAnswer) {
  for (std::size_t i = 0; i < kAnswer3000.size(); ++i) {
    ModbusRtu fresh;
    Bytes out(ModbusRtu::kLongestFrame);
    (void)fresh.begin(kTwoRegisters, now, kTimeout, out);
    auto wrong = kAnswer3000;
    wrong[i] = static_cast<std::uint8_t>(wrong[i] ^ 0x04U);
    feed(fresh, wrong, now);
    EXPECT_EQ(fresh.state(), ModbusState::kWaiting) << i;
    feed(fresh, kAnswer3000, now);
    EXPECT_EQ(fresh.state(), ModbusState::kDone) << i;
  }
}

TEST_F(ModbusRtuTest, AnswersOfOthersAreNoise) {
  (void)begin(kTwoRegisters);
  answer(frame("02 03 04 00 00 00 01"));  // another slave
  answer(frame("01 04 04 00 00 00 01"));  // another function
  answer(frame("01 03 02 00 01"));        // another number of registers
  EXPECT_EQ(modbus.state(), ModbusState::kWaiting);
  EXPECT_EQ(modbus.counters().frames, 0U);
  answer(kAnswer3000);
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
}

TEST_F(ModbusRtuTest, SurvivesItsOwnEchoOfARead) {
  const auto asked = begin(kTwoRegisters);
  answer(asked);
  EXPECT_EQ(modbus.state(), ModbusState::kWaiting);
  answer(kAnswer3000);
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
}

TEST_F(ModbusRtuTest, NobodyAnswersABroadcast) {
  const std::array<std::uint16_t, 1> value{1};
  EXPECT_EQ(begin({.address = 0, .function = ModbusFunction::kWriteSingle, .first = 5, .values = value}),
            frame("00 06 00 05 00 01"));
  EXPECT_EQ(modbus.state(), ModbusState::kDone);
}

TEST_F(ModbusRtuTest, QuestionsThatAreNotAllowedDoNotBegin) {
  const std::array<std::uint16_t, 124> many{};
  const auto write = [&](ModbusFunction function, std::size_t count, std::uint8_t address) {
    return ModbusRequest{.address = address, .function = function, .values = std::span(many).first(count)};
  };
  for (const auto& request :
       {ModbusRequest{.count = 0}, ModbusRequest{.count = 126}, ModbusRequest{.address = 0},
        ModbusRequest{.address = 248}, write(ModbusFunction::kWriteSingle, 0, 1),
        write(ModbusFunction::kWriteSingle, 2, 1), write(ModbusFunction::kWriteMultiple, 0, 1),
        write(ModbusFunction::kWriteMultiple, 124, 1), ModbusRequest{.function = ModbusFunction{5}}}) {
    EXPECT_THAT(begin(request), IsEmpty());
    EXPECT_EQ(modbus.state(), ModbusState::kIdle);
  }
  EXPECT_EQ(begin(write(ModbusFunction::kWriteMultiple, 123, 247)).size(), 7U + 246U + 2U);
}

TEST_F(ModbusRtuTest, ABufferThatIsTooShortBeginsNothing) {
  Bytes out(7);
  EXPECT_EQ(modbus.begin(kTwoRegisters, now, kTimeout, out), 0U);
  EXPECT_EQ(modbus.state(), ModbusState::kIdle);
}

TEST_F(ModbusRtuTest, ANewOpeningGivesTheQuestionUp) {
  (void)begin(kTwoRegisters);
  modbus.restart();
  EXPECT_EQ(modbus.state(), ModbusState::kTimedOut);
  modbus.restart();
  EXPECT_EQ(modbus.modbusCounters().timeouts, 1U);
}

TEST(ModbusRtu, EverySplitGivesTheSame) {
  const auto stream =
      joined({noise(9, 1), hex("01 03"), hex("01 03 04 00 00 0B B8 FD 70"), kAnswer3000, noise(9, 2)});
  expectTheSameForEverySplit(
      stream,
      [] {
        auto modbus = std::make_unique<ModbusRtu>();
        Bytes out(ModbusRtu::kLongestFrame);
        (void)modbus->begin(kTwoRegisters, MonotonicTime{1s}, kTimeout, out);
        return modbus;
      },
      [](const ModbusRtu& m) { return m.modbusCounters().answers; });
}

TEST(ModbusRtu, TheFrameGapFollowsFromTheFormat) {
  EXPECT_EQ(ModbusRtu::frameGap(SerialFormat::make(9600, "8E1").value()), 4010415ns);
  EXPECT_EQ(ModbusRtu::frameGap(SerialFormat::make(115200, "8N1").value()), 1750us);
}

TEST(ModbusRtu, PacksAnyFunction) {
  const ModbusRtu modbus;
  Bytes out(8);
  ASSERT_EQ(modbus.pack_frame(hex("01 05 00 00 FF 00"), out), 8U);
  EXPECT_EQ(out, frame("01 05 00 00 FF 00"));
  EXPECT_EQ(modbus.pack_frame(hex("01 05 00 00 FF 00 00"), out), 0U);
  EXPECT_EQ(modbus.pack_frame(hex("01"), out), 0U);
}

TEST(ModbusRtu, AllocatesNothing) {
  ModbusRtu modbus;
  std::array<std::uint8_t, ModbusRtu::kLongestFrame> out;
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) {
    const MonotonicTime now{i * 10ms};
    (void)modbus.begin(kTwoRegisters, now, kTimeout, out);
    modbus.parse_stream(kAnswer3000, now + 2ms);
  }
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_EQ(modbus.modbusCounters().answers, 100U);
}

}  // namespace
}  // namespace rc10::test::modbus_rtu_test
