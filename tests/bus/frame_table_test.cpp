#include "bus/frame_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "bus/fake_devices.hpp"

namespace rc10::test::frame_table_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

CanFrame frameWith(CanId id, std::initializer_list<std::uint8_t> payload = {}) {
  return makeClassicFrame(id, std::span(payload.begin(), payload.size()));
}

class FrameTableTest : public testing::Test {
 protected:
  FakeDevice& add(std::string name, std::vector<FrameFilter> filters) {
    FakeDevice& device = devices_.emplace_back(std::move(name), std::move(filters));
    const auto ok = table_->add(device);
    EXPECT_TRUE(ok) << (ok ? "" : ok.error().message);
    return device;
  }

  std::string refusal(std::string name, std::vector<FrameFilter> filters) {
    FakeDevice& device = devices_.emplace_back(std::move(name), std::move(filters));
    const auto ok = table_->add(device);
    return ok ? "(accepted)" : ok.error().message;
  }

  FrameListener* find(const CanFrame& frame) const { return table_->find(frame); }

  std::unique_ptr<FrameTable> table_ = std::make_unique<FrameTable>();
  std::deque<FakeDevice> devices_;
};

TEST_F(FrameTableTest, IsEmptyAtFirst) {
  EXPECT_EQ(find(frameWith({0x201, false})), nullptr);
  EXPECT_EQ(find(frameWith({0x201, true})), nullptr);
  EXPECT_EQ(table_->size(), 0U);
}

TEST_F(FrameTableTest, FindsEachOfEightMotorsByItsId) {
  std::vector<FakeDevice*> motors;
  for (std::uint32_t id = 1; id <= 8; ++id) {
    motors.push_back(&add("m" + std::to_string(id), {standardFilter(0x200 + id)}));
  }
  for (std::uint32_t id = 1; id <= 8; ++id) {
    EXPECT_EQ(find(frameWith({0x200 + id, false})), motors[id - 1]);
  }
  EXPECT_EQ(find(frameWith({0x200, false})), nullptr);
  EXPECT_EQ(find(frameWith({0x209, false})), nullptr);
}

TEST_F(FrameTableTest, FindsTheFirstAndTheLastStandardId) {
  FakeDevice& first = add("first", {standardFilter(0)});
  FakeDevice& last = add("last", {standardFilter(0x7FF)});
  EXPECT_EQ(find(frameWith({0, false})), &first);
  EXPECT_EQ(find(frameWith({0x7FF, false})), &last);
}

TEST_F(FrameTableTest, TheSameNumberCanBeAStandardAndAnExtendedDevice) {
  FakeDevice& standard = add("standard", {standardFilter(0x201)});
  FakeDevice& extended = add("extended", {extendedFilter(0x201)});
  EXPECT_EQ(find(frameWith({0x201, false})), &standard);
  EXPECT_EQ(find(frameWith({0x201, true})), &extended);
}

TEST_F(FrameTableTest, ADeviceMayListenToSeveralIds) {
  FakeDevice& vesc = add("vesc", {extendedFilter(0x0901), extendedFilter(0x0E01), extendedFilter(0x1B01)});
  FakeDevice& other = add("other", {extendedFilter(0x0902), extendedFilter(0x0E02), extendedFilter(0x1B02)});
  EXPECT_EQ(find(frameWith({0x0901, true})), &vesc);
  EXPECT_EQ(find(frameWith({0x1B01, true})), &vesc);
  EXPECT_EQ(find(frameWith({0x0E02, true})), &other);
  EXPECT_EQ(find(frameWith({0x0903, true})), nullptr);
}

TEST_F(FrameTableTest, FiltersOfOneDeviceMayOverlap) {
  FakeDevice& device = add("wide", {robStrideFilter(1), extendedFilter(0x0101)});
  EXPECT_EQ(find(frameWith({0x0101, true})), &device);
}

TEST_F(FrameTableTest, FindsTheMotorIdInsideAVaryingExtendedId) {
  FakeDevice& one = add("one", {robStrideFilter(1)});
  FakeDevice& two = add("two", {robStrideFilter(2)});
  for (const std::uint32_t type : {0x00U, 0x02U, 0x11U, 0x18U}) {
    for (const std::uint32_t detail : {0x00U, 0x80U, 0xFFU}) {
      const std::uint32_t around = type << 24U | detail << 16U | 0xFDU;
      EXPECT_EQ(find(frameWith({around | 0x0100U, true})), &one);
      EXPECT_EQ(find(frameWith({around | 0x0200U, true})), &two);
      EXPECT_EQ(find(frameWith({around | 0x0300U, true})), nullptr);
    }
  }
}

TEST_F(FrameTableTest, AMaskedStandardFilterCoversAllItsIds) {
  FakeDevice& odrive = add("odrive", {{.id = {3U << 5U, false}, .mask = 0x7E0}});
  EXPECT_EQ(find(frameWith({0x60, false})), &odrive);
  EXPECT_EQ(find(frameWith({0x7F, false})), &odrive);
  EXPECT_EQ(find(frameWith({0x80, false})), nullptr);
  EXPECT_EQ(find(frameWith({0x5F, false})), nullptr);
}

TEST_F(FrameTableTest, DevicesOnOneIdAreToldApartByThePayload) {
  FakeDevice& one = add("one", {damiaoFilter(0x00, 1)});
  FakeDevice& two = add("two", {damiaoFilter(0x00, 2)});
  EXPECT_EQ(find(frameWith({0x00, false}, {0x11, 0, 0})), &one);
  EXPECT_EQ(find(frameWith({0x00, false}, {0x12, 0, 0})), &two);
  EXPECT_EQ(find(frameWith({0x00, false}, {0x13, 0, 0})), nullptr);
  EXPECT_EQ(find(frameWith({0x00, false})), nullptr);
}

TEST_F(FrameTableTest, ADeviceAloneOnItsIdIsToldByEachOfItsBytes) {
  for (const std::size_t place : {0U, 1U}) {
    FrameFilter filter = standardFilter(0x20 + static_cast<std::uint32_t>(place));
    filter.discriminators[place] = PayloadDiscriminator{.byte_index = 2, .value = 0x55};
    FakeDevice& device = add("d" + std::to_string(place), {filter});
    EXPECT_EQ(find(frameWith(filter.id, {0, 0, 0x55})), &device) << place;
    EXPECT_EQ(find(frameWith(filter.id, {0, 0, 0x33})), nullptr) << place;
    EXPECT_EQ(find(frameWith(filter.id, {0, 0})), nullptr) << place;
  }
}

TEST_F(FrameTableTest, TheDeviceHasTheLastWord) {
  FakeDevice& device = add("picky", {standardFilter(0x201)});
  device.matches = false;
  EXPECT_EQ(find(frameWith({0x201, false})), nullptr);
}

TEST_F(FrameTableTest, FindsNoDeviceForRemoteAndErrorFrames) {
  add("four", {standardFilter(0x004)});
  CanFrame frame = frameWith({0x004, false});
  frame.type = FrameType::kError;
  EXPECT_EQ(find(frame), nullptr);
  frame.type = FrameType::kRemote;
  EXPECT_EQ(find(frame), nullptr);
}

TEST_F(FrameTableTest, FindsNoDeviceForAnIdThatDoesNotExist) {
  add("one", {standardFilter(0x001)});
  EXPECT_EQ(find(frameWith({0x801, false})), nullptr);
}

TEST_F(FrameTableTest, RefusesACollisionAndNamesBothDevicesAndTheId) {
  add("front_left", {standardFilter(0x205)});
  EXPECT_THAT(refusal("yaw", {standardFilter(0x204), standardFilter(0x205)}),
              AllOf(HasSubstr("'front_left'"), HasSubstr("'yaw'"), HasSubstr("standard id 0x205")));
}

TEST_F(FrameTableTest, NamesAnIdThatBothMasksAccept) {
  add("robstride", {robStrideFilter(9)});
  EXPECT_THAT(refusal("vesc", {extendedFilter(0x0901)}),
              AllOf(HasSubstr("'robstride'"), HasSubstr("'vesc'"), HasSubstr("extended id 0x00000901")));
}

TEST_F(FrameTableTest, RefusesAPayloadThatBothAccept) {
  add("one", {damiaoFilter(0x11, 1)});
  EXPECT_THAT(refusal("again", {damiaoFilter(0x11, 1)}), HasSubstr("standard id 0x011"));
  EXPECT_THAT(refusal("all", {standardFilter(0x11)}), HasSubstr("standard id 0x011"));
}

TEST_F(FrameTableTest, ARefusedDeviceLeavesNoTrace) {
  add("first", {standardFilter(0x205)});
  EXPECT_THAT(refusal("second", {standardFilter(0x204), extendedFilter(7), standardFilter(0x205)}),
              HasSubstr("'first'"));
  EXPECT_EQ(table_->size(), 1U);
  EXPECT_EQ(find(frameWith({0x204, false})), nullptr);
  EXPECT_EQ(find(frameWith({7, true})), nullptr);
  FakeDevice& third = add("third", {standardFilter(0x204), extendedFilter(7)});
  EXPECT_EQ(find(frameWith({7, true})), &third);
}

TEST_F(FrameTableTest, RefusesASecondDeviceOfTheSameName) {
  add("wheel", {standardFilter(0x201)});
  EXPECT_THAT(refusal("wheel", {standardFilter(0x202)}), HasSubstr("two devices have the name 'wheel'"));
}

TEST_F(FrameTableTest, RefusesADeviceThatIsAlreadyThere) {
  FakeDevice& device = add("wheel", {standardFilter(0x201)});
  const auto again = table_->add(device);
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("'wheel' is registered twice"));
}

TEST_F(FrameTableTest, RefusesAnIdThatDoesNotExist) {
  EXPECT_THAT(refusal("far", {standardFilter(0x800)}), AllOf(HasSubstr("'far'"), HasSubstr("0x800")));
  EXPECT_THAT(refusal("further", {extendedFilter(0x2000'0000)}), HasSubstr("out of range"));
}

TEST_F(FrameTableTest, RefusesADiscriminatorBeyondTheLongestPayload) {
  for (const std::size_t place : {0U, 1U}) {
    FrameFilter filter = standardFilter(1);
    filter.discriminators[place] = PayloadDiscriminator{.byte_index = 64};
    EXPECT_THAT(refusal("deep", {filter}), AllOf(HasSubstr("'deep'"), HasSubstr("byte 64"))) << place;
  }
}

TEST_F(FrameTableTest, HoldsThirtyTwoDevicesAndRefusesTheNext) {
  for (std::uint32_t id = 0; id < 32; ++id)
    add("m" + std::to_string(id), {damiaoFilter(0x10 + id / 16, id % 16)});
  EXPECT_THAT(refusal("one_more", {standardFilter(0x300)}),
              AllOf(HasSubstr("'one_more'"), HasSubstr("at most 32 devices")));
  for (std::uint32_t id = 0; id < 32; ++id) {
    EXPECT_EQ(find(frameWith({0x10 + id / 16, false}, {static_cast<std::uint8_t>(id % 16)})), &devices_[id]);
  }
}

TEST_F(FrameTableTest, HoldsFiveHundredAndTwelveExtendedIdsAndRefusesTheNext) {
  for (std::uint32_t d = 0; d < 8; ++d) {
    std::vector<FrameFilter> filters;
    for (std::uint32_t i = 0; i < 64; ++i) filters.push_back(extendedFilter(i << 8U | d));
    add("m" + std::to_string(d), std::move(filters));
  }
  EXPECT_THAT(refusal("too_much", {extendedFilter(0xABCD)}),
              AllOf(HasSubstr("'too_much'"), HasSubstr("at most 512 filters")));
  for (std::uint32_t d = 0; d < 8; ++d) {
    for (std::uint32_t i = 0; i < 64; ++i) ASSERT_EQ(find(frameWith({i << 8U | d, true})), &devices_[d]);
  }
  EXPECT_EQ(find(frameWith({64U << 8U, true})), nullptr);
}

TEST_F(FrameTableTest, HoldsSixteenMasksAndRefusesTheNext) {
  std::vector<FrameFilter> filters;
  for (std::uint32_t i = 0; i < 16; ++i)
    filters.push_back({.id = {i << 20U, true}, .mask = 0x1FF0'0000U | i});
  FakeDevice& many = add("many", filters);
  EXPECT_THAT(refusal("another", {{.id = {0x1000'0000, true}, .mask = 0x1FF0'0010}}),
              AllOf(HasSubstr("'another'"), HasSubstr("at most 16 different masks")));
  EXPECT_EQ(find(frameWith({7U << 20U | 0x8, true})), &many);
}

}  // namespace
}  // namespace rc10::test::frame_table_test
