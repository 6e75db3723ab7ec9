// The file on its way: from the hand-off ring to the history and back out of the file.

#include "blackbox/history.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/unique_fd.hpp"
#include "blackbox/box_file.hpp"
#include "blackbox/image.hpp"
#include "blackbox/memory_box.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::test::history_test {
namespace {

using ::testing::HasSubstr;

// The smallest file: a quarter of it is the ring.
constexpr std::uint64_t kBytes = std::uint64_t{1} << 20U;

class HistoryTest : public ::testing::Test {
 protected:
  explicit HistoryTest(const std::string& in = "/tmp") : dir(in) {}

  void write(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      auto frame = numberedFrame(next++);
      ASSERT_TRUE(out.write(frame, kNumberedFrameBytes));
    }
  }
  void drain() { ASSERT_TRUE(history.drain()); }

  /// The file as a reader finds it. Checks that no frame is missing in between.
  std::vector<blackbox::Frame> framesInFile() {
    EXPECT_TRUE(file->publish());
    auto image = blackbox::readImage(file->path());
    if (!image) {
      ADD_FAILURE() << image.error().message;
      return {};
    }
    const auto recording = blackbox::Recording::parse(*image).value();
    EXPECT_EQ(recording.damagedBytes(), 0U);
    auto frames = all<blackbox::Frame>(recording);
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_EQ(numberOf(frames[i]), numberOf(frames[i - 1]) + 1);
    }
    return frames;
  }

  TempDir dir;
  const std::unique_ptr<blackbox::BoxFile> file =
      blackbox::BoxFile::create(dir / "hero.blackbox", blackbox::Header{}, kBytes).value();
  blackbox::HandOff out{file->head().control, file->ring()};
  blackbox::History history{file->head(), file->ring(), file->descriptor()};
  std::uint64_t next = 0;
};

/// Where the run folder is in memory, as /run is, the hand-off ring lies in the file.
class HistoryInMemoryTest : public HistoryTest {
 protected:
  HistoryInMemoryTest() : HistoryTest("/dev/shm") {}
};

TEST_F(HistoryTest, AnEmptyFileIsAWholeRecordingOfNothing) { EXPECT_TRUE(framesInFile().empty()); }

TEST_F(HistoryTest, TheFileHasItsSizeFromTheStart) {
  EXPECT_EQ(::lseek(file->descriptor(), 0, SEEK_END), static_cast<off_t>(kBytes));
}

TEST_F(HistoryTest, EverythingIsThereAsLongAsThereIsRoom) {
  for (int i = 0; i < 20; ++i) {
    write(500);
    drain();
  }
  const auto frames = framesInFile();
  ASSERT_EQ(frames.size(), 10'000U);
  EXPECT_EQ(numberOf(frames.front()), 0U);
}

TEST_F(HistoryTest, TheNewestOverwriteTheOldest) {
  const std::uint64_t room = file->head().header.history_bytes / kNumberedFrameBytes;
  while (next < 5 * room) {
    write(997);
    drain();
    const auto newest = next - 1;
    const auto frames = framesInFile();
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(numberOf(frames.back()), newest);
    EXPECT_GE(frames.size(), std::min(next, room) - 1);
  }
}

TEST_F(HistoryTest, RecordsOfDifferentSizesAreOverwrittenAtTheirBoundaries) {
  for (int i = 0; i < 200; ++i) {
    write(100);
    for (int j = 0; j < 20; ++j) {
      blackbox::Motor motor;
      motor.header.time_ns = static_cast<std::int64_t>(next) * 1000;
      ASSERT_TRUE(out.write(motor));
    }
    drain();
  }
  const auto frames = framesInFile();
  EXPECT_EQ(numberOf(frames.back()), next - 1);
  EXPECT_GT(frames.size(), 10'000U);
}

TEST_F(HistoryInMemoryTest, AReaderFindsTheNewestAlsoBeforeTheyAreDrained) {
  write(200);
  drain();
  write(100);
  EXPECT_EQ(framesInFile().size(), 300U);
}

TEST_F(HistoryInMemoryTest, AReaderOfAFileThatIsBeingWrittenFindsNoGapAndNoHalfRecord) {
  std::atomic<bool> stop{false};
  std::thread scheduler_and_io([&] {
    while (!stop) {
      write(50);
      drain();
    }
  });
  for (int i = 0; i < 200; ++i) (void)framesInFile();
  stop = true;
  scheduler_and_io.join();
}

TEST_F(HistoryTest, WhenTheFileCannotBeWrittenTheHandOffGoesOn) {
  const UniqueFd read_only{::open(file->path().c_str(), O_RDONLY | O_CLOEXEC)};
  blackbox::History broken{file->head(), file->ring(), read_only.get()};
  write(100);
  EXPECT_FALSE(broken.drain());
  write(100);
  EXPECT_TRUE(broken.drain());  // complains once
  for (int i = 0; i < 100; ++i) {
    write(5000);
    EXPECT_TRUE(broken.drain());
  }
  EXPECT_EQ(file->head().control.dropped, 0U);
  EXPECT_TRUE(framesInFile().empty());
}

/// One who cuts off the file of a running rc10d: at nothing, in the middle of the ring, of the history.
class CutFileTest : public HistoryInMemoryTest, public testing::WithParamInterface<off_t> {
 protected:
  void cut() { ASSERT_EQ(::truncate(file->path().c_str(), GetParam()), 0); }
};

TEST_P(CutFileTest, RecordingGoesOnWithoutAFileAndTheProcessLives) {
  write(100);
  drain();
  EXPECT_TRUE(file->whole());
  cut();
  EXPECT_FALSE(file->whole());
  for (int i = 0; i < 40; ++i) {
    write(2000);
    (void)history.drain();
  }
  EXPECT_FALSE(file->whole());
  EXPECT_EQ(file->head().control.dropped, 0U) << "the hand-off goes on";
  ASSERT_TRUE(file->end());
}

TEST_P(CutFileTest, OneThatHasItsSizeAgainIsReadAsWhatIsLeftOfIt) {
  write(100);
  drain();
  cut();
  ASSERT_EQ(::truncate(file->path().c_str(), static_cast<off_t>(kBytes)), 0);
  for (int i = 0; i < 40; ++i) {
    write(2000);
    (void)history.drain();  // ends, whatever is in the file
  }
  EXPECT_LE(file->head().control.oldest, file->head().control.tail);
}

INSTANTIATE_TEST_SUITE_P(At, CutFileTest, testing::Values(0, 100'000, static_cast<off_t>(kBytes) - 4096));

/// By the signal; or by the handler of a sanitizer, which was there before.
bool hasDied(int status) { return status != 0; }

TEST(CutFileGuard, AFileThatIsCutOffElsewhereEndsTheProcessAsBefore) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  TempDir dir("/dev/shm");
  const auto file = blackbox::BoxFile::create(dir / "hero.blackbox", blackbox::Header{}, kBytes).value();
  const UniqueFd other{::open((dir / "other").c_str(), O_RDWR | O_CREAT, 0600)};
  ASSERT_EQ(::ftruncate(other.get(), 4096), 0);
  void* const memory = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, other.get(), 0);
  ASSERT_NE(memory, MAP_FAILED);
  ASSERT_EQ(::ftruncate(other.get(), 0), 0);
  std::filesystem::remove_all(dir.path());  // now: the two that die here remove nothing
  EXPECT_EXIT(*static_cast<volatile char*>(memory) = 1, hasDied, "");
  EXPECT_EXIT(::raise(SIGBUS), hasDied, "");
  EXPECT_EQ(::munmap(memory, 4096), 0);
}

TEST_F(HistoryTest, NoRoomForTheFileIsAnErrorThatNamesIt) {
  const auto none = blackbox::BoxFile::create("/nowhere/hero.blackbox", blackbox::Header{}, kBytes);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("/nowhere/hero.blackbox"));
}

TEST(Image, AFileThatIsCutOffIsNamed) {
  TempDir dir;
  const auto path = dir / "hero.blackbox";
  { const auto file = blackbox::BoxFile::create(path, blackbox::Header{}, kBytes).value(); }
  ASSERT_EQ(::truncate(path.c_str(), 500'000), 0);
  const auto image = blackbox::readImage(path);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().message, path + ": it is cut off: it has 500000 of 1048576 bytes");
  ASSERT_EQ(::truncate(path.c_str(), 10), 0);
  EXPECT_THAT(blackbox::readImage(path).error().message, HasSubstr("no black box"));
  EXPECT_THAT(blackbox::readImage(dir / "none").error().message, HasSubstr("No such file"));
}

}  // namespace
}  // namespace rc10::test::history_test
