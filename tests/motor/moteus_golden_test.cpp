// Frames of the vendor's documents and library, byte for byte, both ways.
// Sources: mjbots/moteus@db1a762 docs/protocol/can.md, lib/cpp/mjbots/moteus/moteus_protocol.h.
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "support/hex_bytes.hpp"
#include "support/moteus_answers.hpp"

namespace rc10::test::moteus_golden_test {
namespace {

using enum moteus::Register;
using Kind = moteus::Item::Kind;

std::vector<std::uint8_t> bytes(const CanFrame& frame) {
  return {frame.payload().begin(), frame.payload().end()};
}

using Row = std::tuple<Kind, moteus::Register, double>;
std::vector<Row> decoded(const std::string& hex) {
  const auto payload = hexBytes(hex);
  moteus::Reader reader(payload);
  std::vector<Row> rows;
  moteus::Item item;
  while (reader.next(item) == moteus::Reader::Step::kItem) rows.emplace_back(item.kind, item.reg, item.value);
  return rows;
}

void expectRows(const std::string& hex, const std::vector<Row>& expected) {
  const auto rows = decoded(hex);
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(std::get<0>(rows[i]), std::get<0>(expected[i])) << i;
    EXPECT_EQ(std::get<1>(rows[i]), std::get<1>(expected[i])) << i;
    EXPECT_NEAR(std::get<2>(rows[i]), std::get<2>(expected[i]), 1e-9) << i;
  }
}

moteus::Writer writer() { return {moteus::queryId(0, 1), true}; }

constexpr auto kPositionCommand = "01000A0E200000803F0000004011001F01130D50";
constexpr auto kInt16Command = "01000A07206000200150FF140400130D";
constexpr auto kInt16Reply = "2404000A005000000170FF230D181400";

TEST(MoteusGolden, IdsAreThoseOfTheVendor) {
  EXPECT_EQ(moteus::queryId(0, 1), (CanId{0x8001, true}));
  EXPECT_EQ(moteus::replyId(0, 1), (CanId{0x100, false}));
  EXPECT_EQ(moteus::replyId(0, 7), (CanId{0x700, false}));
  EXPECT_EQ(moteus::replyId(0, 8), (CanId{0x800, true})) << "more than 11 bits";
  EXPECT_EQ(moteus::queryId(0x13, 2), (CanId{0x138002, true}));
  EXPECT_EQ(moteus::replyId(0x13, 2), (CanId{0x130200, true}));
}

TEST(MoteusGolden, APositionCommandIsThatOfTheLibrary) {
  const CanFrame frame = writer()
                             .write(moteus::Type::kInt8, kMode, {10.0})
                             .write(moteus::Type::kFloat, kCommandPosition, {1.0, 2.0})
                             .read(moteus::Type::kInt8, kMode)
                             .read(moteus::Type::kFloat, kPosition, 3)
                             .read(moteus::Type::kInt8, kVoltage, 3)
                             .frame();
  EXPECT_EQ(bytes(frame), hexBytes(kPositionCommand));
  EXPECT_EQ(frame.length, 20) << "19 bytes, padded with NOP";
  EXPECT_TRUE(frame.fd);
  EXPECT_TRUE(frame.bit_rate_switch);
  expectRows(kPositionCommand, {{Kind::kWrite, kMode, 10},
                                {Kind::kWrite, kCommandPosition, 1.0},
                                {Kind::kWrite, kCommandVelocity, 2.0},
                                {Kind::kRead, kMode, 0},
                                {Kind::kRead, kPosition, 0},
                                {Kind::kRead, kVelocity, 0},
                                {Kind::kRead, kTorque, 0},
                                {Kind::kRead, kVoltage, 0},
                                {Kind::kRead, kTemperature, 0},
                                {Kind::kRead, kFault, 0}});
}

// The document's text has the torque's sign wrong; its bytes are -176.
TEST(MoteusGolden, ACommandInInt16IsThatOfTheDocument) {
  const CanFrame frame = writer()
                             .write(moteus::Type::kInt8, kMode, {10.0})
                             .write(moteus::Type::kInt16, kCommandPosition, {0.0096, 0.072, -1.76})
                             .read(moteus::Type::kInt16, kMode, 4)
                             .read(moteus::Type::kInt8, kVoltage, 3)
                             .frame();
  EXPECT_EQ(bytes(frame), hexBytes(kInt16Command));
}

TEST(MoteusGolden, AReplyInInt16IsThatOfTheDocument) {
  const CanFrame frame = writer()
                             .reply(moteus::Type::kInt16, kMode, {10.0, 0.008, 0.064, -1.44})
                             .reply(moteus::Type::kInt8, kVoltage, {12.0, 20.0, 0.0})
                             .frame();
  EXPECT_EQ(bytes(frame), hexBytes(kInt16Reply));
  expectRows(kInt16Reply, {{Kind::kReply, kMode, 10},
                           {Kind::kReply, kPosition, 0.008},
                           {Kind::kReply, kVelocity, 0.064},
                           {Kind::kReply, kTorque, -1.44},
                           {Kind::kReply, kVoltage, 12.0},
                           {Kind::kReply, kTemperature, 20.0},
                           {Kind::kReply, kFault, 0.0}});
}

TEST(MoteusGolden, StopAndBrakeAreThoseOfTheDocument) {
  EXPECT_EQ(bytes(writer().write(moteus::Type::kInt8, kMode, {0.0}).frame()), hexBytes("010000"));
  EXPECT_EQ(bytes(writer().write(moteus::Type::kInt8, kMode, {15.0}).frame()), hexBytes("01000F"));
}

TEST(MoteusGolden, TheShortestQueryAndItsReplyAreThoseOfTheDocument) {
  EXPECT_EQ(bytes(writer().read(moteus::Type::kInt8, kMode).read(moteus::Type::kInt8, kFault).frame()),
            hexBytes("1100110F"));
  expectRows("210000210F00", {{Kind::kReply, kMode, 0}, {Kind::kReply, kFault, 0}});
}

TEST(MoteusGolden, TheMotorsRestIsTheVendorsStop) {
  MoteusBench bench;
  ASSERT_EQ(bench.motor.packRest(bench.frames), 1U);
  EXPECT_EQ(bench.frames[0].id, (CanId{0x8001, true}));
  EXPECT_EQ(bytes(bench.frames[0]), hexBytes("010000"));
}

TEST(MoteusGolden, TheMotorsPollStopsAndAsks) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kPoll);
  bench.tick();
  EXPECT_EQ(bytes(bench.frames[0]), hexBytes("01000011001F011504130D1570505050"));
}

// Mode 10; 0.25 rev, 1.5 rev/s, 0.5 N·m; 3.2 A; 24 V, 31 °C, no fault; 1234 ms.
TEST(MoteusGolden, AnAnswerBecomesReadingsOfTheOutput) {
  MoteusBench bench;
  CanFrame frame;
  frame.id = {0x100, false};
  frame.fd = true;
  const auto payload = hexBytes("21000A2F010000803E0000C03F0000003F25042000230D301F002570D2045050");
  frame.length = static_cast<std::uint8_t>(payload.size());
  std::copy(payload.begin(), payload.end(), frame.data.begin());
  frame.received = bench.now;
  ASSERT_TRUE(bench.motor.matchesFrame(frame));
  ASSERT_EQ(bench.motor.updateFeedback(frame), FrameVerdict::kAccepted);
  const auto& feedback = bench.motor.feedback();
  EXPECT_FLOAT_EQ(feedback.velocity_rpm, 90.0F);
  EXPECT_FLOAT_EQ(feedback.torque_nm, 0.5F);
  EXPECT_FLOAT_EQ(feedback.current_a, 3.2F);
  EXPECT_FLOAT_EQ(feedback.voltage_v, 24.0F);
  EXPECT_FLOAT_EQ(feedback.temperature_c, 31.0F);
  EXPECT_FALSE(feedback.zeroed);
}

}  // namespace
}  // namespace rc10::test::moteus_golden_test
