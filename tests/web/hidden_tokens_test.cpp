#include "web/hidden_tokens.hpp"

#include <string>

#include <gmock/gmock.h>

#include "config/load_config.hpp"
#include "config/sha256.hpp"

namespace rc10::web::test::hidden_tokens_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kToken = "abcdefghijkmnpqrstuvwxyz23456789";
const std::string kHash = sha256(kToken);
const std::string kOther = sha256("another");

std::string robotWith(const std::string& clients) {
  return "robot: hero\n" + clients +
         "buses: [{name: a, type: sim, motors: [{name: m, model: M3508, id: 1}]}]\n";
}
std::string entry(const std::string& token, const std::string& may = "[command]") {
  return "  - {token: " + token + ", may: " + may + "}\n";
}

TEST(HiddenTokens, AFileWithoutTokensIsShownAsItIs) {
  const auto text = robotWith("# " + kHash + "\nclients:\n  - {user: root, may: [command]}\n");
  const auto shown = showConfig(text, "");
  EXPECT_EQ(shown.text, text);
  EXPECT_EQ(shown.hidden, 0);
}

TEST(HiddenTokens, AHashOfATokenIsHiddenBesideTheOthersAndInComments) {
  const auto shown = showConfig(
      robotWith("# anna: " + kToken + "\nclients:\n" + entry(kHash) + entry("\"" + kOther + "\"")), "");
  EXPECT_EQ(shown.hidden, 3);
  for (const auto& secret : {kToken, kHash, kOther}) EXPECT_THAT(shown.text, Not(HasSubstr(secret)));
  EXPECT_THAT(shown.text, HasSubstr("may: [command]"));
}

TEST(HiddenTokens, OnlyATokenThatMayConfigureShowsThem) {
  const auto text = robotWith("clients:\n" + entry(kHash, "[configure]") + entry(kOther));
  EXPECT_EQ(showConfig(text, kToken).text, text);
  EXPECT_EQ(showConfig(text, "another").hidden, 2);
  EXPECT_EQ(showConfig(text, kHash).hidden, 2);
  EXPECT_EQ(showConfig(robotWith("clients:\n" + entry(kHash)), kToken).hidden, 1);
}

TEST(HiddenTokens, OnlyATokenThatMayConfigureMayHaveAFileWithClientsReplaced) {
  const auto text = robotWith("clients:\n" + entry(kHash, "[configure]") + entry(kOther));
  EXPECT_TRUE(mayReplace(text, kToken));
  for (const auto& token : {std::string{}, std::string{"another"}, kHash})
    EXPECT_FALSE(mayReplace(text, token));
  EXPECT_FALSE(mayReplace(robotWith("clients:\n  - {user: root, may: [configure]}\n"), ""));
  EXPECT_TRUE(mayReplace(robotWith(""), ""));
  EXPECT_FALSE(mayReplace("robot: hero\nclients: nonsense\n", kToken));
}

TEST(HiddenTokens, AHashBehindAnAnchorIsHidden) {
  const auto shown = showConfig(
      robotWith("clients:\n  - {token: &t " + kHash + ", may: [command]}\n  - {token: *t, may: [tune]}\n"),
      "");
  EXPECT_EQ(shown.hidden, 1);
  EXPECT_THAT(shown.text, Not(HasSubstr(kHash)));
}

TEST(HiddenTokens, AHashThatIsWrittenInEscapesLetsNothingBeShown) {
  std::string escaped = "\"";
  for (const char c : kHash) {
    escaped += (c >= 'a' ? "\\x6" : "\\x3");
    escaped += static_cast<char>('0' + c % 16);
  }
  // Behind an anchor: a reader of lines does not see that it is a token's.
  const auto text = robotWith("clients:\n  - {token: &t " + escaped + "\", may: [command]}\n");
  ASSERT_TRUE(parseRobotConfig(text, "").config) << parseRobotConfig(text, "").text();
  const auto shown = showConfig(text, "");
  EXPECT_EQ(shown.text, "");
  EXPECT_THAT(shown.why, HasSubstr("open the file itself"));
}

TEST(HiddenTokens, InAFileWithMistakesTokensAreHiddenTooAlsoThoseThatAreNone) {
  const auto shown =
      showConfig(robotWith("clients:\n" + entry(kHash) + entry("my-own-secret")) + "oops\n", "");
  EXPECT_EQ(shown.hidden, 2);
  EXPECT_THAT(shown.text, Not(HasSubstr(kHash)));
  EXPECT_THAT(shown.text, Not(HasSubstr("my-own-secret")));
  EXPECT_THAT(shown.text, HasSubstr("oops"));
}

TEST(HiddenTokens, TheCheckerAcceptsHiddenOnesAtTheSameColumnsAndRc10dDoesNot) {
  const auto text = robotWith("clients:\n" + entry(kHash) + entry(kOther, "[fly]"));
  const auto shown = showConfig(text, "").text;
  const auto before = parseRobotConfig(text, "f").errors;
  const auto after = parseRobotConfig(withHashes(shown), "f").errors;
  ASSERT_EQ(before.size(), 1U);
  ASSERT_EQ(after.size(), 1U);
  EXPECT_EQ(before[0].place.line, after[0].place.line);
  EXPECT_EQ(before[0].place.column, after[0].place.column);
  EXPECT_FALSE(parseRobotConfig(shown, "f").config);
  EXPECT_THAT(parseRobotConfig(shown, "f").errorText(), HasSubstr("clients[0].token"));
}

}  // namespace
}  // namespace rc10::web::test::hidden_tokens_test
