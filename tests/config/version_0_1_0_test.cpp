// Robots of 0.1.0: what was a good file then is one today.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "config/load_config.hpp"
#include "config/report/schema.hpp"
#include "config/yaml/yaml_reader.hpp"

namespace rc10::test::version_0_1_0_test {
namespace {

const std::filesystem::path kFolder = std::filesystem::path{RC10_SOURCE_DIR} / "tests/package/0.1.0";

TEST(Version010, ItsExampleRobotsAreAccepted) {
  int robots = 0;
  for (const auto& entry : std::filesystem::directory_iterator{kFolder / "config"}) {
    const auto outcome = loadRobotConfig(entry.path().string());
    EXPECT_TRUE(outcome) << outcome.errorText();
    ++robots;
  }
  EXPECT_EQ(robots, 6);
}

/// "section.key", as the JSON schema has them: JSON is YAML.
bool hasKey(const YamlNode& schema, const std::string& path) {
  const auto dot = path.find('.');
  const YamlNode* node = &schema;
  for (const auto& step :
       {std::string{"$defs"}, path.substr(0, dot), std::string{"properties"}, path.substr(dot + 1)}) {
    node = node->find(step);
    if (node == nullptr) return false;
  }
  return true;
}

// A key that goes or is called otherwise leaves this list when its line in a file is answered with its new
// name.
TEST(Version010, NoneOfItsKeysIsUnknown) {
  Problems problems{"schema"};
  const auto schema = readYaml(configSchema(), problems);
  ASSERT_TRUE(schema);
  std::ifstream keys{kFolder / "keys.txt"};
  int known = 0;
  for (std::string key; std::getline(keys, key); ++known) EXPECT_TRUE(hasKey(*schema, key)) << key;
  EXPECT_EQ(known, 464);
}

}  // namespace
}  // namespace rc10::test::version_0_1_0_test
