#include "robot_file/file_desk.hpp"

#include <gmock/gmock.h>

#include "config/sha256.hpp"
#include "robot_file/folder.hpp"
#include "robot_file/this_computer.hpp"

namespace rc10::robot_file::test::file_desk_test {
namespace {

using client::FileAnswer;
using client::FileRequest;
using client::FileVerb;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A computer that allows everything and says what it was asked for.
struct Desk {
  Folder folder;
  std::vector<std::string> asked;
  Result<void> allowed;
  Result<std::string> verdict = std::string{"robot 'hero'"};
  Result<void> rest;

  FileAnswer ask(FileVerb verb, const std::string& robot = "hero", const std::string& text = "new",
                 const std::string& replaces = {}) {
    const Computer computer{.authorise =
                                [&](const Caller& caller, FileVerb of) {
                                  asked.push_back("may " + std::to_string(caller.user) + " " + toString(of));
                                  return allowed;
                                },
                            .check =
                                [&](const std::string& of) {
                                  asked.push_back("check " + of);
                                  return verdict;
                                },
                            .at_rest =
                                [&](const std::string& of, const std::string& unit) {
                                  asked.push_back("rest " + of + " " + unit);
                                  return rest;
                                },
                            .restart = [&](const std::string& unit) -> Result<void> {
                              asked.push_back("restart " + unit);
                              return {};
                            }};
    return answer({.verb = verb, .robot = robot, .replaces = replaces, .text = text},
                  {.process = {}, .user = 998}, folder.path(), computer, 1795705445);
  }
};

TEST(FileDesk, WithoutARuleOfPolkitNothingIsDone) {
  Desk desk;
  desk.folder.write("robot.yaml", "old");
  desk.allowed = fail("no rule");
  for (const auto verb : {FileVerb::kCheck, FileVerb::kInstall, FileVerb::kRestart}) {
    desk.asked.clear();
    const auto answer = desk.ask(verb);
    EXPECT_FALSE(answer.done);
    EXPECT_EQ(answer.message, "no rule");
    EXPECT_THAT(desk.asked, ElementsAre("may 998 " + std::string{toString(verb)}));
  }
  EXPECT_EQ(desk.folder.read("robot.yaml"), "old");
}

TEST(FileDesk, InstallsWhatRc10dAccepts) {
  Desk desk;
  desk.folder.write("robot.yaml", "old");
  const auto answer = desk.ask(FileVerb::kInstall, "hero", "new", sha256("old"));
  EXPECT_TRUE(answer.done) << answer.message;
  EXPECT_THAT(answer.message,
              HasSubstr("the old one is " + desk.folder.pathOf("robot.yaml.2026-11-26T15-04-05Z")));
  EXPECT_EQ(desk.folder.read("robot.yaml"), "new");
}

TEST(FileDesk, WhatRc10dRefusesIsNotInstalled) {
  Desk desk;
  desk.folder.write("robot.yaml", "old");
  desk.verdict = fail("robot.yaml:1:1: no robot");
  const auto answer = desk.ask(FileVerb::kInstall);
  EXPECT_FALSE(answer.done);
  EXPECT_EQ(answer.message, "robot.yaml:1:1: no robot");
  EXPECT_THAT(desk.folder.files(), ElementsAre("robot.yaml"));
}

TEST(FileDesk, AFileThatSomebodyElseHasChangedSinceStays) {
  Desk desk;
  desk.folder.write("robot.yaml", "somebody else's");
  const auto answer = desk.ask(FileVerb::kInstall, "hero", "new", sha256("old"));
  EXPECT_FALSE(answer.done);
  EXPECT_THAT(answer.message, HasSubstr("has changed since"));
  EXPECT_EQ(desk.folder.read("robot.yaml"), "somebody else's");
}

TEST(FileDesk, TheSameTextAgainLeavesNoBackup) {
  Desk desk;
  desk.folder.write("robot.yaml", "new");
  EXPECT_TRUE(desk.ask(FileVerb::kInstall).done);
  EXPECT_THAT(desk.folder.files(), ElementsAre("robot.yaml"));
}

TEST(FileDesk, ARobotWithAFileOfItsNameIsThatOfTheInstance) {
  Desk desk;
  desk.folder.write("robot.yaml", "old");
  desk.folder.write("left_arm.yaml", "old");
  EXPECT_TRUE(desk.ask(FileVerb::kInstall, "left_arm").done);
  EXPECT_EQ(desk.folder.read("left_arm.yaml"), "new");
  EXPECT_EQ(desk.folder.read("robot.yaml"), "old");
  EXPECT_TRUE(desk.ask(FileVerb::kRestart, "left_arm").done);
  EXPECT_EQ(desk.asked.back(), "restart rc10d@left_arm.service");
  EXPECT_TRUE(desk.ask(FileVerb::kRestart, "robot").done);
  EXPECT_EQ(desk.asked.back(), "restart rc10d.service");
}

TEST(FileDesk, RestartsOnlyARobotAtRest) {
  Desk desk;
  desk.rest = fail("motor 'arm' is ACTIVE");
  EXPECT_FALSE(desk.ask(FileVerb::kRestart).done);
  EXPECT_EQ(desk.asked.back(), "rest hero rc10d.service");
  desk.rest = {};
  EXPECT_TRUE(desk.ask(FileVerb::kRestart).done);
  EXPECT_EQ(desk.asked.back(), "restart rc10d.service");
}

TEST(FileDesk, ACheckTouchesNoFile) {
  Desk desk;
  const auto answer = desk.ask(FileVerb::kCheck);
  EXPECT_TRUE(answer.done);
  EXPECT_EQ(answer.message, "robot 'hero'");
  EXPECT_TRUE(desk.folder.files().empty());
}

TEST(FileDesk, EachVerbIsAnActionOfPolkitInThePolicy) {
  std::ostringstream policy;
  policy << std::ifstream{std::string{RC10_SOURCE_DIR} + "/systemd/polkit/org.rc10d.config.policy"}.rdbuf();
  for (const auto verb : {FileVerb::kCheck, FileVerb::kInstall, FileVerb::kRestart})
    EXPECT_THAT(policy.str(), HasSubstr("<action id=\"" + polkitAction(verb) + "\">"));
  EXPECT_EQ(policy.str().find("yes"), std::string::npos);
  EXPECT_EQ(policy.str().find("auth_"), std::string::npos);
}

}  // namespace
}  // namespace rc10::robot_file::test::file_desk_test
