#include "web/recordings.hpp"

#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "blackbox/memory_box.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::web::test::recordings_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RecordingsTest : public ::testing::Test {
 protected:
  static std::vector<std::byte> image() {
    rc10::test::MemoryBox box{std::size_t{1} << 20U};
    auto out = box.handOff();
    for (std::uint64_t i = 0; i < 1000; ++i) {
      auto frame = rc10::test::numberedFrame(i);
      out.write(frame, rc10::test::kNumberedFrameBytes);
    }
    return box.image();
  }
  static void write(const std::string& path, const std::vector<std::byte>& bytes) {
    std::ofstream{path, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                                static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& file : recordings.list()) found.push_back(file.name);
    return found;
  }

  rc10::test::TempDir run;
  rc10::test::TempDir state;
  Recordings recordings{run.path(), state.path()};
};

TEST_F(RecordingsTest, TheLiveOneComesFirstThenTheNewestCopy) {
  write(state / "hero-20260101T000000Z-estop.blackbox", image());
  write(state / "hero-20260102T000000Z-fault.blackbox", image());
  const auto now = std::filesystem::file_time_type::clock::now();
  std::filesystem::last_write_time(state / "hero-20260101T000000Z-estop.blackbox",
                                   now - std::chrono::hours{2});
  std::filesystem::last_write_time(state / "hero-20260102T000000Z-fault.blackbox",
                                   now - std::chrono::hours{1});
  write(run / "hero.blackbox", image());
  std::filesystem::last_write_time(run / "hero.blackbox", now - std::chrono::hours{3});
  EXPECT_THAT(names(), ElementsAre("hero.blackbox", "hero-20260102T000000Z-fault.blackbox",
                                   "hero-20260101T000000Z-estop.blackbox"));
}

TEST_F(RecordingsTest, OneFolderForBothHasEachOnce) {
  const Recordings shared{run.path(), run.path()};
  write(run / "hero.blackbox", image());
  write(run / "hero-20260101T000000Z-estop.blackbox", image());
  const auto found = shared.list();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "hero.blackbox");
  EXPECT_TRUE(found[0].live);
  EXPECT_FALSE(found[1].live);
}

TEST_F(RecordingsTest, OtherFilesAndLinksAreNone) {
  write(run / "hero.sock", image());
  write(run / "web-token", image());
  write(state / "secret", image());
  std::filesystem::create_symlink(state / "secret", run / "link.blackbox");
  std::filesystem::create_directory(run / "folder.blackbox");
  EXPECT_THAT(names(), ElementsAre());
  for (const auto* name : {"link.blackbox", "folder.blackbox", "hero.sock", "../secret", "", "web-token"}) {
    const auto opened = recordings.open(name);
    ASSERT_FALSE(opened) << name;
    EXPECT_THAT(opened.error().message, HasSubstr("no such recording"));
  }
}

TEST_F(RecordingsTest, APageGetsTheFileInPiecesTheBeginningLast) {
  const auto file = image();
  write(run / "hero.blackbox", file);
  auto opened = recordings.open("hero.blackbox");
  ASSERT_TRUE(opened);
  std::vector<std::byte> got(opened->reader.fileBytes());
  bool last = false;
  while (!last) {
    const auto frame = pieceFrame(opened->reader, 7, last);
    ASSERT_TRUE(frame);
    std::uint32_t bytes = 0;
    std::uint32_t number = 0;
    double offset = 0.0;
    std::memcpy(&bytes, frame->data() + 4, sizeof bytes);
    std::memcpy(&number, frame->data() + 8, sizeof number);
    std::memcpy(&offset, frame->data() + 16, sizeof offset);
    EXPECT_EQ(number, 7U);
    ASSERT_EQ(frame->size(), 32 + bytes);
    ASSERT_LE(static_cast<std::size_t>(offset) + bytes, got.size());
    EXPECT_EQ(last, offset == 0.0);
    std::memcpy(got.data() + static_cast<std::size_t>(offset), frame->data() + 32, bytes);
  }
  EXPECT_TRUE(got == file);
}

TEST_F(RecordingsTest, ADamagedOneIsRefusedByItsName) {
  auto bytes = image();
  bytes.resize(bytes.size() / 2);
  write(run / "hero.blackbox", bytes);
  const auto opened = recordings.open("hero.blackbox");
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("hero.blackbox: it is cut off"));
}

}  // namespace
}  // namespace rc10::web::test::recordings_test
