// Frames computed by hand from LK-Tech's CAN protocol V2.35, both ways.
#include <gtest/gtest.h>

#include "drives/lktech/lktech_frames.hpp"
#include "drives/lktech/lktech_model.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::lktech_golden_test {
namespace {

using namespace lktech;

TEST(LKTechGolden, CommandsAreThoseOfTheProtocol) {
  EXPECT_EQ(textOf(currentCommand(1, -500)), "141#A10000000CFE0000");
  EXPECT_EQ(textOf(velocityCommand(1, 90.0, 0)), "141#A200000028230000") << "the document's 90 dps";
  EXPECT_EQ(textOf(positionCommand(2, -360.0, 360.0)), "142#A40068016073FFFF");
  EXPECT_EQ(textOf(request(1, Code::kOn)), "141#8800000000000000");
  EXPECT_EQ(textOf(request(32, Code::kStatus)), "160#9A00000000000000");
}

TEST(LKTechGolden, FourCurrentsGoInOneFrame) {
  EXPECT_EQ(textOf(groupCommand({100, -200, 300, -2000})), "280#640038FF2C0130F8");
  EXPECT_EQ(textOf(groupCommand({0, 0, 0, -9999})), "280#00000000000030F8") << "+-2000 is the range";
}

TEST(LKTechGolden, ARawCurrentMeansAnotherCurrentForMfAndMg) {
  EXPECT_NEAR(-500 * findLktechModel("LK-MF9025")->amperes_per_raw, -4.0283, 1e-4);
  EXPECT_NEAR(-500 * findLktechModel("LK-MG5010E-i10")->amperes_per_raw, -8.0566, 1e-4);
  EXPECT_NEAR(248 * findLktechModel("LK-MF9025")->amperes_per_raw, 1.9980, 1e-4);
}

TEST(LKTechGolden, TheReadingReplyTellsTemperatureCurrentSpeedAndEncoder) {
  const auto frame = frameOf("141#A128F80098FE00C0");
  EXPECT_FALSE(looksLikeCommand(frame.payload()));
  const auto reading = decodeReading(frame.payload());
  EXPECT_EQ(reading.temperature_c, 40);
  EXPECT_EQ(reading.current_raw, 248);
  EXPECT_EQ(reading.rotor_deg_s, -360);
  EXPECT_EQ(reading.encoder, 49152);
}

TEST(LKTechGolden, TheStatusReplyTellsVoltageStateAndErrors) {
  const auto frame = frameOf("141#9A1EC01264001008");
  const auto status = decodeStatus(frame.payload());
  EXPECT_EQ(status.temperature_c, 30);
  EXPECT_DOUBLE_EQ(status.voltage_v, 48.0);
  EXPECT_TRUE(status.off);
  EXPECT_EQ(status.errors, 0x08);
}

TEST(LKTechGolden, TheAngleReplyIsInHundredthsOfADegreeAfterTheCommandByte) {
  const auto forwards = frameOf("141#92A08C0000000000");
  EXPECT_EQ(decodeAngle(forwards.payload()), 36000);
  const auto backwards = frameOf("141#926073FFFFFFFFFF");
  EXPECT_EQ(decodeAngle(backwards.payload()), -36000);
  const auto short_one = frameOf("141#926073FFFF000000");
  EXPECT_EQ(decodeAngle(short_one.payload()), 4'294'931'296)
      << "V2.35 has 7 bytes; of firmware that filled 4, angles below 0 would be told as out of reach";
}

TEST(LKTechGolden, CommandsAreToldFromRepliesByTheirBytes) {
  for (const auto& frame :
       {currentCommand(1, -500), velocityCommand(1, 90.0, 700), positionCommand(1, -360.0, 360.0),
        request(1, Code::kStatus), request(1, Code::kAngle), request(1, Code::kReading)}) {
    EXPECT_TRUE(looksLikeCommand(frame.payload())) << textOf(frame);
  }
}

}  // namespace
}  // namespace rc10::test::lktech_golden_test
