#include "config/sha256.hpp"

#include <gtest/gtest.h>

#include "config/load_config.hpp"

namespace rc10::test::sha256_test {
namespace {

// FIPS 180-4's examples.
TEST(Sha256, IsAsSha256sumPrintsIt) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, OfARobotIsThatOfItsFileByteForByte) {
  const std::string text =
      "robot: hero\nbuses:\n  - {name: can, type: sim, motors: [{name: m, model: M3508, id: 1}]}\n";
  const auto robot = parseRobotConfig(text, "hero.yaml");
  ASSERT_TRUE(robot) << robot.errorText();
  EXPECT_EQ(robot.config->hash, sha256(text));
  EXPECT_NE(parseRobotConfig(text + "\n", "hero.yaml").config->hash, robot.config->hash);
}

}  // namespace
}  // namespace rc10::test::sha256_test
