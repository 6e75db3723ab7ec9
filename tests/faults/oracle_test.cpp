#include "faults/oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "faults/chaos.hpp"
#include "faults/robots.hpp"

namespace rc10::test {
namespace oracle_test {

using Kind = Chaos::Lie::Kind;

constexpr std::uint64_t kMostTicks = 400'000;

struct Case {
  std::size_t robot = 0;
  std::size_t motor = 0;
  std::string name;
  friend void PrintTo(const Case& which, std::ostream* out) { *out << which.name; }
};

std::vector<Case> everyMotor() {
  std::vector<Case> cases;
  for (std::size_t robot = 0; robot < kRobotCount; ++robot) {
    const RobotConfig config = robotOf(robot);
    std::size_t motor = 0;
    for (const auto& bus : config.buses) {
      for (const auto& entry : bus.motors)
        cases.push_back({robot, motor++, config.robot + "_" + entry.name()});
    }
  }
  return cases;
}

/// The oracle's own proof: of each motor of the soak, in each family, it sees what is wrong.
class OracleSees : public ::testing::TestWithParam<Case> {
 protected:
  static std::string findingOf(Kind kind) {
    SeededChoices choices{7};
    Chaos chaos{choices, Chaos::Lie{GetParam().robot, GetParam().motor, kind}};
    try {
      while (chaos.ticks() < kMostTicks) chaos.step();
    } catch (const Violation& finding) {
      return finding.what();
    }
    return "nothing";
  }
};

TEST_P(OracleSees, AMotorBeyondItsLimits) {
  EXPECT_THAT(findingOf(Kind::kLimits), ::testing::HasSubstr("limit"));
}

TEST_P(OracleSees, AMotorThatGoesOnThoughNobodyCommandsIt) {
  const auto finding = findingOf(Kind::kStuck);
  EXPECT_NE(finding, "nothing");
}

INSTANTIATE_TEST_SUITE_P(EachMotor, OracleSees, ::testing::ValuesIn(everyMotor()),
                         [](const auto& param) { return param.param.name; });

}  // namespace oracle_test
}  // namespace rc10::test
