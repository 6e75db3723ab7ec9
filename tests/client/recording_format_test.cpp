#include "client/recording_format.hpp"

#include <cstddef>
#include <cstring>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "blackbox/memory_box.hpp"

namespace rc10::test::recording_format_test {
namespace {

using nlohmann::json;

class RecordingFormat : public ::testing::Test {
 protected:
  // A number of an image at the place that the format names.
  template <typename T>
  T read(const std::vector<std::byte>& image, std::size_t base, const json& field) {
    T value;
    EXPECT_EQ(field["bytes"], sizeof value);
    std::memcpy(&value, image.data() + base + field["at"].get<std::size_t>(), sizeof value);
    return value;
  }
  json format = json::parse(client::recordingFormatJson());
};

TEST_F(RecordingFormat, HasThePlacesOfTheHeaderAndOfARecord) {
  MemoryBox box;
  blackbox::Motor motor;
  motor.velocity_rpm = 12.5F;
  motor.fault = -3;
  motor.header.source = 1;
  auto out = box.handOff();
  out.write(motor, sizeof motor);
  const auto image = box.image();
  const auto& header = format["structures"]["header"]["fields"];
  EXPECT_EQ(read<std::uint32_t>(image, 0, header["version"]), format["version"]);
  EXPECT_EQ(read<std::int32_t>(image, 0, header["pid"]), 42);
  EXPECT_EQ(header["robot"],
            json({{"at", header["robot"]["at"]}, {"type", "text"}, {"bytes", 32}, {"count", 1}}));
  const auto& table = format["tables"]["motors"];
  const auto motors = table["at"].get<std::size_t>();
  const auto each = format["structures"]["motor_info"]["bytes"].get<std::size_t>();
  EXPECT_STREQ(reinterpret_cast<const char*>(image.data() + motors + each), "right");
  const auto& fields = format["structures"][format["kinds"][6].get<std::string>()]["fields"];
  EXPECT_EQ(read<float>(image, blackbox::kRingOffset, fields["velocity_rpm"]), 12.5F);
  EXPECT_EQ(fields["velocity_rpm"]["type"], "f32");
  EXPECT_EQ(read<std::int32_t>(image, blackbox::kRingOffset, fields["fault"]), -3);
  const auto control = format["control_at"].get<std::size_t>();
  EXPECT_EQ(read<std::uint64_t>(image, control, format["structures"]["control"]["fields"]["head"]),
            sizeof motor);
}

TEST_F(RecordingFormat, ArraysSayHowManyAndTypesSayWhichTheyAre) {
  const auto& frame = format["structures"]["frame"]["fields"]["data"];
  EXPECT_EQ(frame, json({{"at", 16}, {"type", "u8"}, {"bytes", 1}, {"count", 64}}));
  EXPECT_EQ(format["structures"]["order"]["fields"]["motors"]["type"], "u64");
  EXPECT_EQ(format["structures"]["module_info"]["fields"]["inputs"]["count"], 32);
  EXPECT_EQ(format["structures"]["control"]["fields"]["wall_offset_ns"]["type"], "i64");
  EXPECT_EQ(format["kinds"].size(), 10U);
  EXPECT_EQ(format["kinds"][0], "");
}

TEST_F(RecordingFormat, HasTheWordsOfTheProtocol) {
  EXPECT_EQ(format["words"]["status"][3], "ACTIVE");
  EXPECT_EQ(format["words"]["operation"][2], "estop");
  EXPECT_EQ(format["faults"]["1"].get<std::string>().substr(0, 10), "over-speed");
  EXPECT_EQ(format["events"]["first_bus"], 300);
}

}  // namespace
}  // namespace rc10::test::recording_format_test
