#include "app/nearest.hpp"

#include <gtest/gtest.h>

namespace rc10::test::nearest_test {
namespace {

TEST(Nearest, AWordThatIsNearIsOffered) {
  EXPECT_EQ(didYouMean("enabel", {"disable", "enable", "estop"}), "; did you mean enable?");
  EXPECT_EQ(didYouMean("Front-Left", {"rear_left", "front_left"}), "; did you mean front_left?");
}

TEST(Nearest, AWordWithoutItsUnitIsOfferedTheOneThatHasIt) {
  EXPECT_EQ(didYouMean("inertia", {"inertia_kg_m2", "coulomb_nm"}), "; did you mean inertia_kg_m2?");
  EXPECT_EQ(didYouMean("track", {"track_m", "wheelbase_m"}), "; did you mean track_m?");
  EXPECT_EQ(didYouMean("angle_min", {"angle_pid", "angle_min_deg"}), "; did you mean angle_min_deg?");
  EXPECT_EQ(didYouMean("wheels", {"wheel", "wheels_limit_rpm"}), "; did you mean wheel?");
}

TEST(Nearest, AWordThatTwoBeginWithIsOfferedBoth) {
  EXPECT_EQ(didYouMean("payload", {"gravity_nm", "payload_kg", "payload_at_m"}),
            "; did you mean payload_kg or payload_at_m?");
  EXPECT_EQ(didYouMean("stop", {"stop_min_deg", "stop_max_deg"}),
            "; did you mean stop_min_deg or stop_max_deg?");
  EXPECT_EQ(didYouMean("stop", {"stop_min_deg", "stop_max_deg", "stop_at_m"}), "");
  EXPECT_EQ(didYouMean("payload_x", {"payload_kg", "payload_at_m"}), "; did you mean payload_kg?");
}

TEST(Nearest, AWordThatIsNothingLikeThemIsNot) {
  EXPECT_EQ(didYouMean("gripper", {"disable", "enable"}), "");
  EXPECT_EQ(didYouMean("", {"enable"}), "");
  EXPECT_EQ(didYouMean("enable", {}), "");
}

}  // namespace
}  // namespace rc10::test::nearest_test
