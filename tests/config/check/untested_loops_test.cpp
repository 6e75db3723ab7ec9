#include "config/check/untested_loops.hpp"

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::untested_loops_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> loopsOf(const std::string& drive, const std::string& fallbacks = "") {
  return untestedLoops(motorOf("{name: a, " + drive + fallbacks + "}"));
}

TEST(UntestedLoops, AMotorThatCoastsHasNone) {
  EXPECT_THAT(loopsOf("model: M3508, id: 1"), IsEmpty());
  EXPECT_THAT(loopsOf("model: M3508, id: 1", ", on_timeout: coast, on_disable: coast, on_estop: coast"),
              IsEmpty());
}

TEST(UntestedLoops, EachOfTheThreeKeysIsNamedWithItsValue) {
  EXPECT_THAT(loopsOf("model: M3508, id: 1", ", on_timeout: hold"), ElementsAre("on_timeout: hold"));
  EXPECT_THAT(loopsOf("model: M3508, id: 1", ", on_disable: ramp"), ElementsAre("on_disable: ramp"));
  EXPECT_THAT(loopsOf("model: M3508, id: 1", ", on_estop: brake"), ElementsAre("on_estop: brake"));
  EXPECT_THAT(loopsOf("model: GM6020, id: 1", ", on_timeout: brake, on_disable: hold, on_estop: ramp"),
              ElementsAre("on_timeout: brake", "on_disable: hold", "on_estop: ramp"));
}

TEST(UntestedLoops, ADampThatRc10dComputesIsOneAndThatOfADriveIsNone) {
  EXPECT_THAT(loopsOf("model: M3508, id: 1", ", on_timeout: damp"), ElementsAre("on_timeout: damp"));
  EXPECT_THAT(loopsOf("model: DM4310, id: 1, master_id: 17", ", on_timeout: damp, on_disable: damp"),
              IsEmpty());
  EXPECT_THAT(loopsOf("model: DM4310, id: 1, master_id: 17", ", on_disable: brake"),
              ElementsAre("on_disable: brake"));
}

}  // namespace
}  // namespace rc10::test::untested_loops_test
