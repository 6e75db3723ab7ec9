#include "blackbox/recording.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <functional>
#include <random>

#include "blackbox/memory_box.hpp"

namespace rc10::test::recording_test {
namespace {

using ::testing::HasSubstr;

std::string errorOf(const std::vector<std::byte>& image) {
  const auto recording = blackbox::Recording::parse(image);
  return recording ? "" : recording.error().message;
}

MemoryBox boxWithFrames(std::uint64_t count) {
  MemoryBox box(4096);
  auto out = box.handOff();
  for (std::uint64_t i = 0; i < count; ++i) {
    auto frame = numberedFrame(i);
    out.write(frame, kNumberedFrameBytes);
  }
  return box;
}

TEST(Recording, IsInTheOrderOfTime) {
  MemoryBox box;
  auto out = box.handOff();
  // A tick: first what was received before it, stamped by the kernel, bus after bus.
  for (const std::uint64_t number : {7U, 9U, 6U, 8U, 10U}) {
    auto frame = numberedFrame(number);
    out.write(frame, kNumberedFrameBytes);
  }
  std::uint64_t expected = 6;
  const auto recording = box.recording();
  for (const auto& frame : all<blackbox::Frame>(recording)) EXPECT_EQ(numberOf(frame), expected++);
  EXPECT_EQ(recording.firstNs(), 6000);
  EXPECT_EQ(recording.lastNs(), 10'000);
}

TEST(Recording, KnowsTheWallClock) {
  auto box = boxWithFrames(1);
  box.head().control.wall_offset_ns = 1'000'000'000'000'000;
  EXPECT_EQ(box.recording().wallUs(5000), 1'000'000'000'005);
}

TEST(Recording, ARecordThatIsCutOffAtTheEndIsLeftOutAndCounted) {
  auto box = boxWithFrames(10);
  box.head().control.head -= 8;
  const auto recording = box.recording();
  EXPECT_EQ(recording.size(), 9U);
  EXPECT_EQ(recording.damagedBytes(), kNumberedFrameBytes - 8);
}

TEST(Recording, WhatFollowsAHalfWrittenRecordIsCountedAsDamaged) {
  auto box = boxWithFrames(10);
  auto image = box.image();
  const auto at = blackbox::kRingOffset + 5 * kNumberedFrameBytes;
  for (std::size_t i = 0; i < kNumberedFrameBytes; ++i) image[at + i] = std::byte{0};
  const auto recording = blackbox::Recording::parse(image).value();
  EXPECT_EQ(recording.size(), 5U);
  EXPECT_EQ(recording.damagedBytes(), 5 * kNumberedFrameBytes);
}

TEST(Recording, TypesOfALaterVersionArePassedOver) {
  auto box = boxWithFrames(3);
  auto image = box.image();
  image[blackbox::kRingOffset + kNumberedFrameBytes] = std::byte{200};
  const auto recording = blackbox::Recording::parse(image).value();
  EXPECT_EQ(recording.size(), 2U);
  EXPECT_EQ(recording.damagedBytes(), 0U);
}

TEST(Recording, NamesThatTheHeaderDoesNotHaveAreQuestionMarks) {
  const auto recording = boxWithFrames(1).recording();
  EXPECT_EQ(recording.motorName(1), "right");
  EXPECT_EQ(recording.motorName(2), "?");
  EXPECT_EQ(recording.busName(0), "chassis");
  EXPECT_EQ(recording.interfaceName(0), "can0");
  EXPECT_EQ(recording.interfaceName(255), "?");
}

TEST(Recording, SomethingElseIsNoBlackBox) {
  EXPECT_THAT(errorOf({}), HasSubstr("no black box"));
  EXPECT_THAT(errorOf(std::vector<std::byte>(100'000)), HasSubstr("no black box"));
}

TEST(Recording, AnotherFormatIsRefusedWithBothNumbers) {
  auto box = boxWithFrames(1);
  box.head().header.version = 7;
  EXPECT_EQ(errorOf(box.image()),
            "it was written by another version of rc10d (format 7, this program reads 3)");
}

TEST(Recording, AFileThatIsCutOffIsRefused) {
  auto image = boxWithFrames(1).image();
  image.pop_back();
  EXPECT_THAT(errorOf(image), HasSubstr("cut off"));
}

TEST(Recording, EveryHeaderThatContradictsItselfIsRefused) {
  using blackbox::FileHead;
  const std::vector<std::function<void(FileHead&)>> damages{
      [](FileHead& h) { h.header.ring_bytes = 0; },
      [](FileHead& h) { h.header.ring_bytes = 4095; },
      [](FileHead& h) { h.header.ring_bytes = std::uint64_t{1} << 63U; },
      [](FileHead& h) { h.header.ring_offset = 8; },
      [](FileHead& h) { h.header.ring_offset = ~std::uint64_t{0} - 100; },
      [](FileHead& h) { h.header.history_offset += 8; },
      [](FileHead& h) { h.header.history_bytes = 0; },
      [](FileHead& h) { h.header.file_bytes = ~std::uint64_t{0}; },
      [](FileHead& h) { h.header.bus_count = 5; },
      [](FileHead& h) { h.header.motor_count = 129; },
      [](FileHead& h) { h.control.tail = h.control.head + 8; },
      [](FileHead& h) { h.control.head = h.control.tail + 8192; },
      [](FileHead& h) { h.control.oldest = h.control.head + 8; },
      [](FileHead& h) { h.control.head = h.control.tail = 4096; },
  };
  for (std::size_t i = 0; i < damages.size(); ++i) {
    auto image = boxWithFrames(10).image();
    FileHead head;
    std::memcpy(&head, image.data(), sizeof head);
    damages[i](head);
    std::memcpy(image.data(), &head, sizeof head);
    EXPECT_THAT(errorOf(image), HasSubstr("damaged")) << i;
  }
}

TEST(Recording, AnyDamageIsARecordingOrAnError) {
  std::mt19937 random(1);
  const auto whole = boxWithFrames(100).image();
  int read = 0;
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    auto image = whole;
    for (int i = 0; i < 20; ++i) image[random() % image.size()] = static_cast<std::byte>(random());
    const auto recording = blackbox::Recording::parse(image);
    if (!recording) {
      EXPECT_NE(recording.error().message, "");
      ++refused;
      continue;
    }
    ++read;
    // No byte counts twice.
    const auto& header = recording->header();
    EXPECT_LE(recording->size() * sizeof(blackbox::RecordHeader) + recording->damagedBytes(),
              header.ring_bytes + header.history_bytes);
    std::int64_t last_ns = recording->firstNs();
    for (std::size_t i = 0; i < recording->size(); ++i) {
      const std::int64_t time_ns = headerOf(recording->at(i)).time_ns;
      EXPECT_GE(time_ns, last_ns);
      last_ns = time_ns;
    }
    EXPECT_EQ(last_ns, recording->lastNs());
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace rc10::test::recording_test
