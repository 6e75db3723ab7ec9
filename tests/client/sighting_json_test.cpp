#include "client/sighting_json.hpp"

#include <gtest/gtest.h>

namespace rc10::client::sighting_json_test {
namespace {

TEST(SightingJson, HasEachGuessWithItsMotorAndNullForNone) {
  link::Sighting sighting;
  sighting.frame_id = 0x205;
  sighting.frames = 1000;
  sighting.ambiguous = 1;
  sighting.guess_count = 2;
  auto& gimbal = sighting.guesses[0];
  gimbal.kind = "DJI GM6020";
  gimbal.id = 1;
  gimbal.from_drive = 1;
  gimbal.motor = "yaw";
  auto& wheel = sighting.guesses[1];
  wheel.kind = "DJI M3508 or M2006";
  wheel.id = 5;
  wheel.from_drive = 1;
  EXPECT_EQ(lineOf(sightingJson(sighting)),
            R"({"frame_id":517,"extended":false,"frames":1000,"ambiguous":true,"guesses":[)"
            R"({"kind":"DJI GM6020","id":1,"from_drive":true,"motor":"yaw","collides":false},)"
            R"({"kind":"DJI M3508 or M2006","id":5,"from_drive":true,"motor":null,"collides":false}],)"
            R"("advice":null})");
}

TEST(SightingJson, ACountBeyondItsRoomReadsNoFarther) {
  link::Sighting sighting;
  sighting.guess_count = 1000;
  EXPECT_EQ(sightingJson(sighting)["guesses"].size(), link::kMaxScanGuesses);
}

}  // namespace
}  // namespace rc10::client::sighting_json_test
