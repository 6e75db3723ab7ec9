#include "gateway/options.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::gateway::test::options_test {
namespace {

using testing::HasSubstr;

Result<Options> parse(std::vector<std::string> words) {
  words.insert(words.begin(), "rc10-lcm");
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  return parseOptions(static_cast<int>(argv.size()), argv.data());
}

TEST(GatewayOptions, AllHaveDefaults) {
  const auto options = parse({});
  ASSERT_TRUE(options);
  EXPECT_FALSE(options->robot || options->socket || options->url || options->help || options->version);
}

TEST(GatewayOptions, AreReadInBothForms) {
  const auto options =
      parse({"--robot", "hero", "--socket=/run/x.sock", "--url", "udpm://239.255.76.67:7667?ttl=0"});
  ASSERT_TRUE(options);
  EXPECT_EQ(options->robot, "hero");
  EXPECT_EQ(options->socket, "/run/x.sock");
  EXPECT_EQ(options->url, "udpm://239.255.76.67:7667?ttl=0");
}

TEST(GatewayOptions, SayWhatIsWrong) {
  EXPECT_THAT(parse({"--robto", "hero"}).error().message,
              HasSubstr("unknown argument '--robto'; did you mean --robot?"));
  EXPECT_THAT(parse({"hero"}).error().message, HasSubstr("unknown argument 'hero'"));
  EXPECT_THAT(parse({"--robot"}).error().message, HasSubstr("--robot needs a value"));
  EXPECT_THAT(parse({"--url="}).error().message, HasSubstr("--url needs a value"));
}

TEST(GatewayOptions, OfferHelp) {
  EXPECT_TRUE(parse({"--help"})->help);
  EXPECT_TRUE(parse({"-h"})->help);
  EXPECT_TRUE(parse({"--version"})->version);
  EXPECT_THAT(helpText(), HasSubstr("--socket"));
}

}  // namespace
}  // namespace rc10::gateway::test::options_test
