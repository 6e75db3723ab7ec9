#include "blackbox/copies.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "app/unique_fd.hpp"
#include "blackbox/box_file.hpp"
#include "blackbox/history.hpp"
#include "blackbox/image.hpp"
#include "blackbox/memory_box.hpp"
#include "blackbox/places.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::test::copies_test {
namespace {

using ::testing::ElementsAre;

// 2026-11-21 16:05:29 UTC
constexpr std::int64_t kTime = 1'795'277'129;

std::set<std::string> filesIn(const std::string& dir) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(dir)) names.insert(entry.path().filename());
  return names;
}

class CopiesTest : public ::testing::Test {
 protected:
  CopiesTest() {
    blackbox::HandOff out{file->head().control, file->ring()};
    for (std::uint64_t i = 0; i < 10; ++i) {
      auto frame = numberedFrame(i);
      out.write(frame, kNumberedFrameBytes);
    }
    EXPECT_TRUE(blackbox::History(file->head(), file->ring(), file->descriptor()).drain());
    EXPECT_TRUE(file->publish());
  }
  Result<std::string> copy(const std::string& to, const std::string& cause = "estop") {
    return blackbox::keepCopy(file->descriptor(), to, "hero", kTime, cause);
  }

  TempDir run;
  TempDir state;
  std::unique_ptr<blackbox::BoxFile> file =
      blackbox::BoxFile::create(run / "hero.blackbox", blackbox::Header{}, std::uint64_t{1} << 20U).value();
};

TEST_F(CopiesTest, ACopyHasTheRobotTheTimeAndTheCauseInItsName) {
  EXPECT_EQ(copy(state.path()).value(), state / "hero-20261121T160529Z-estop.blackbox");
  EXPECT_THAT(filesIn(state.path()), ElementsAre("hero-20261121T160529Z-estop.blackbox"));
}

TEST_F(CopiesTest, ACopyIsToldFromABoxByTheTimeInItsName) {
  EXPECT_TRUE(blackbox::isCopy("hero-20261121T160529Z-estop.blackbox"));
  EXPECT_TRUE(blackbox::isCopy("hero-estop-20261121T160529Z-fault.blackbox"));
  for (const char* box : {"hero.blackbox", "hero-estop.blackbox", "hero-20261121.blackbox",
                          "hero-20261121T160529Z-estop.blackbox.part", "", "-", "hero-2"})
    EXPECT_FALSE(blackbox::isCopy(box)) << box;
}

TEST_F(CopiesTest, ACopyHoldsWhatWasRecordedAndSaysWhyItWasMade) {
  const auto image = blackbox::readImage(copy(state.path()).value()).value();
  const auto recording = blackbox::Recording::parse(image).value();
  EXPECT_EQ(all<blackbox::Frame>(recording).size(), 10U);
  EXPECT_EQ(recording.header().cause.view(), "estop");
}

TEST_F(CopiesTest, AFolderThatIsNotThereIsNamed) {
  EXPECT_EQ(copy(state / "none").error().message, state / "none" + ": No such file or directory");
}

TEST_F(CopiesTest, OfACopyThatFailedNothingIsLeft) {
  // A refusal of the disk: a folder is in the place of the copy.
  std::filesystem::create_directories(state / "hero-20261121T160529Z-estop.blackbox/in");
  EXPECT_FALSE(copy(state.path()));
  EXPECT_THAT(filesIn(state.path()), ElementsAre("hero-20261121T160529Z-estop.blackbox"));
}

TEST_F(CopiesTest, WhatAPowerCutLeftIsOverwritten) {
  std::ofstream(state / "hero.blackbox.part") << std::string(2'000'000, 'x');
  ASSERT_TRUE(copy(state.path()));
  EXPECT_THAT(filesIn(state.path()), ElementsAre("hero-20261121T160529Z-estop.blackbox"));
}

TEST_F(CopiesTest, TheOldestAreRemovedAndNothingElse) {
  for (const auto* name : {"hero-20261121T160529Z-estop.blackbox", "hero-20261121T160530Z-fault.blackbox",
                           "hero-20261121T160531Z-crash.blackbox", "hero-two-20200101T000000Z-estop.blackbox",
                           "hero-notes.blackbox", "hero-20200101T000000Z-estop.log", "notes.txt"}) {
    std::ofstream(state / name) << "x";
  }
  blackbox::removeOldCopies(state.path(), "hero", 2);
  EXPECT_THAT(filesIn(state.path()),
              ElementsAre("hero-20200101T000000Z-estop.log", "hero-20261121T160530Z-fault.blackbox",
                          "hero-20261121T160531Z-crash.blackbox", "hero-notes.blackbox",
                          "hero-two-20200101T000000Z-estop.blackbox", "notes.txt"));
  blackbox::removeOldCopies(state / "none", "hero", 2);
}

TEST(Places, TheStateFolderIsTheUsersElseSystemdsElseTheUsual) {
  ::unsetenv("RC10_STATE_DIR");
  ::unsetenv("STATE_DIRECTORY");
  EXPECT_EQ(blackbox::stateDir(), "/var/lib/rc10d");
  ::setenv("STATE_DIRECTORY", "/var/lib/a:/var/lib/b", 1);
  EXPECT_EQ(blackbox::stateDir(), "/var/lib/a");
  ::setenv("RC10_STATE_DIR", "/tmp/c", 1);
  EXPECT_EQ(blackbox::stateDir(), "/tmp/c");
  ::unsetenv("RC10_STATE_DIR");
  ::unsetenv("STATE_DIRECTORY");
}

}  // namespace
}  // namespace rc10::test::copies_test
