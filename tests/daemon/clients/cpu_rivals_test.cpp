#include "daemon/clients/cpu_rivals.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "daemon/clients/late_tick_causes.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::test::cpu_rivals_test {
namespace {

using namespace std::chrono_literals;

constexpr int kOwn = 41;
constexpr int kFifo = 1;
constexpr int kOther = 0;

/// The files of threads under /proc, as a test writes them.
class Proc {
 public:
  void thread(int tid, const std::string& name, int priority, int policy, int cpu = 2) const {
    std::string stat = std::to_string(tid) + " (" + name + ") S";
    for (int field = 4; field < 39; ++field) stat += " 7";
    write(tid, "stat",
          stat + " " + std::to_string(cpu) + " " + std::to_string(priority) + " " + std::to_string(policy) +
              " 0 0\n");
    used(tid, 0ms);
  }
  void used(int tid, Duration time) const {
    write(tid, "schedstat", std::to_string(time.count()) + " 5 7\n");
  }
  [[nodiscard]] std::filesystem::path path() const { return std::filesystem::path(folder_.path()); }

 private:
  void write(int tid, const char* file, const std::string& text) const {
    const auto task = path() / std::to_string(tid) / "task" / std::to_string(tid);
    std::filesystem::create_directories(task);
    std::ofstream(task / file) << text;
  }

  TempDir folder_;
};

class CpuRivalsTest : public ::testing::Test {
 protected:
  CpuRivalsTest() {
    proc.thread(kOwn, "sched", 60, kFifo);
    proc.thread(7, "irq/57-spi0.0", 70, kFifo);
    proc.thread(8, "migration/0 (odd)", 99, kFifo);
    proc.thread(9, "irq/58-usb", 50, kFifo);
    proc.thread(10, "compiler", 0, kOther);
    rivals.setThread(kOwn);
  }
  void settle() {
    for (int i = 0; i < 100 && !rivals.look(); ++i) {
    }
  }

  Proc proc;
  CpuRivals rivals{60, proc.path()};
};

TEST_F(CpuRivalsTest, NamesTheThreadOfItsPriorityOrAboveThatUsedMost) {
  settle();
  proc.used(7, 3ms);
  proc.used(8, 1ms);
  for (const int precedes_nothing : {kOwn, 9, 10}) proc.used(precedes_nothing, 20ms);
  EXPECT_TRUE(rivals.look());
  EXPECT_EQ(rivals.busiest(2ms), "irq/57-spi0.0");
  EXPECT_EQ(rivals.busiest(4ms), "") << "too little to explain it";
}

TEST_F(CpuRivalsTest, RemembersTheWindowBeforeAndNoMore) {
  settle();
  proc.used(8, 3ms);
  rivals.look();
  rivals.look();
  EXPECT_EQ(rivals.busiest(2ms), "migration/0 (odd)");
  rivals.look();
  EXPECT_EQ(rivals.busiest(2ms), "");
}

TEST_F(CpuRivalsTest, AThreadOnAnotherCpuTookNothing) {
  settle();
  proc.thread(8, "migration/1", 99, kFifo, 1);
  proc.used(8, 5ms);
  proc.used(7, 3ms);
  rivals.look();
  EXPECT_EQ(rivals.busiest(2ms), "irq/57-spi0.0");
}

TEST_F(CpuRivalsTest, AThreadThatCameLaterIsFoundInTime) {
  settle();
  proc.thread(300, "new", 80, kFifo);
  for (int i = 0; i < 150; ++i) rivals.look();
  proc.used(300, 5ms);
  rivals.look();
  EXPECT_EQ(rivals.busiest(1ms), "new");
}

TEST_F(CpuRivalsTest, AThreadThatEndsIsNoMistake) {
  settle();
  std::filesystem::remove_all(proc.path() / "7");
  EXPECT_TRUE(rivals.look());
  EXPECT_EQ(rivals.busiest(1ms), "");
}

TEST_F(CpuRivalsTest, WithoutAProcThereAreNone) {
  CpuRivals none{60, proc.path() / "absent"};
  for (int i = 0; i < 10; ++i) none.look();
  EXPECT_EQ(none.busiest(1ms), "");
}

TEST_F(CpuRivalsTest, FindsManyProcessesInSeveralLooks) {
  for (int tid = 100; tid < 200; ++tid) proc.thread(tid, "busy", 0, kOther);
  proc.thread(300, "late", 80, kFifo);
  int looks = 1;
  while (!rivals.look() && looks < 100) ++looks;
  EXPECT_GT(looks, 5);
  proc.used(300, 5ms);
  rivals.look();
  EXPECT_EQ(rivals.busiest(1ms), "late");
}

TEST_F(CpuRivalsTest, LateTicksAreCountedUnderTheNameFromTheSecondOn) {
  LateTicks late;
  std::uint64_t ticks = 0;
  Duration waited{};
  LateTickCauses causes;
  const auto window = [&] {
    causes.update(late, ticks += 20,
                  {.waited = [&] { return std::optional{waited}; },
                   .page_faults = [] { return std::uint64_t{0}; },
                   .rivals = &rivals});
  };
  Duration used{};
  const auto lateTick = [&] {
    late.record(TickStep::kWake, 900us);
    waited += 900us;
    proc.used(7, used += 850us);
    window();
  };
  window();
  lateTick();
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U) << "rivals are looked for from now on";
  EXPECT_TRUE(causes.takers().empty());
  for (int i = 0; i < 10; ++i) window();
  lateTick();
  EXPECT_EQ(causes.count(LateCause::kCpuTaken), 1U);
  ASSERT_EQ(causes.takers().size(), 1U);
  EXPECT_EQ(causes.takers()[0].name, "irq/57-spi0.0");
  EXPECT_EQ(causes.takers()[0].count, 1U);
}

}  // namespace
}  // namespace rc10::test::cpu_rivals_test
