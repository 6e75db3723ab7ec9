#include "daemon/threads/rt_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <future>
#include <limits>
#include <vector>

namespace rc10::test::rt_thread_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A thread's own view of its settings.
struct Seen {
  std::string name;
  int policy = -1;
  int priority = -1;
  std::size_t stack_bytes = 0;
  cpu_set_t cpus{};
  int tid = 0;
};

Seen look() {
  Seen seen;
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  seen.name = name.data();
  sched_param param{};
  pthread_getschedparam(pthread_self(), &seen.policy, &param);
  seen.priority = param.sched_priority;
  pthread_attr_t attributes;
  pthread_getattr_np(pthread_self(), &attributes);
  pthread_attr_getstacksize(&attributes, &seen.stack_bytes);
  pthread_attr_destroy(&attributes);
  pthread_getaffinity_np(pthread_self(), sizeof seen.cpus, &seen.cpus);
  seen.tid = gettid();
  return seen;
}

/// Runs a thread with these settings to its end.
struct ShortLife {
  explicit ShortLife(const RtSettings& settings) {
    RtThread thread;
    started = thread.start(settings, [this](const std::stop_token&) {
      seen = look();
      ran = true;
    });
    tid = thread.tid();
  }
  Result<void> started;
  Seen seen;
  bool ran = false;
  int tid = 0;
};

TEST(RtThread, HasTheNameThatWasAskedFor) {
  const ShortLife run({"rx", 0, {}});
  ASSERT_TRUE(run.started);
  EXPECT_EQ(run.seen.name, "rx");
  EXPECT_EQ(ShortLife({"a name that is too long", 0, {}}).seen.name, "a name that is ");
}

TEST(RtThread, WithoutAPriorityItIsAnOrdinaryThread) {
  const ShortLife run({"io", 0, {}});
  ASSERT_TRUE(run.started);
  EXPECT_EQ(run.seen.policy, SCHED_OTHER);
  EXPECT_EQ(run.seen.priority, 0);
}

TEST(RtThread, APriorityMeansFifoOrAnErrorThatNamesTheMissingRight) {
  const ShortLife run({"sched", 42, {}});
  EXPECT_TRUE(run.ran);
  if (run.started) {
    EXPECT_EQ(run.seen.policy, SCHED_FIFO);
    EXPECT_EQ(run.seen.priority, 42);
  } else {  // not root
    EXPECT_EQ(run.seen.policy, SCHED_OTHER);
    EXPECT_THAT(run.started.error().message,
                AllOf(HasSubstr("thread sched"), HasSubstr("SCHED_FIFO 42"), HasSubstr("LimitRTPRIO")));
  }
}

TEST(RtThread, ARefusedPolicyIsReportedAndTheBodyRunsAllTheSame) {
  const ShortLife run({"sched", 1000, {}});  // the kernel has 1 to 99
  ASSERT_FALSE(run.started);
  EXPECT_THAT(run.started.error().message,
              AllOf(HasSubstr("thread sched"), HasSubstr("1000"), HasSubstr("refused")));
  EXPECT_TRUE(run.ran);
  EXPECT_EQ(run.seen.policy, SCHED_OTHER);
}

TEST(RtThread, RunsOnItsCpuAlone) {
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  int last = -1;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &allowed)) last = cpu;
  }
  const ShortLife run({"sched", 0, last});
  ASSERT_TRUE(run.started) << run.started.error().message;
  EXPECT_EQ(CPU_COUNT(&run.seen.cpus), 1);
  EXPECT_TRUE(CPU_ISSET(static_cast<std::size_t>(last), &run.seen.cpus));
}

TEST(RtThread, ACpuThatIsNotThereIsReportedWithTheOnesThereAre) {
  const ShortLife run({"sched", 0, CPU_SETSIZE - 1});
  ASSERT_FALSE(run.started);
  EXPECT_THAT(run.started.error().message,
              AllOf(HasSubstr("CPU 1023"), HasSubstr("this machine has CPUs 0 to ")));
  EXPECT_TRUE(run.ran);
}

TEST(RtThread, HasASmallStack) {
  const ShortLife run({"rx", 0, {}});
  EXPECT_GE(run.seen.stack_bytes, std::size_t{100} * 1024);
  EXPECT_LE(run.seen.stack_bytes, std::size_t{2048} * 1024) << "8 MiB is the usual one, and locked whole";
}

TEST(RtThread, ItsStackIsTouchedBeforeTheBodyRuns) {
  constexpr std::uintptr_t kUsed = std::uintptr_t{64} * 1024;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> resident(kUsed / page);
  int looked = -1;
  RtThread thread;
  ASSERT_TRUE(thread.start({"rx", 0, {}}, [&](const std::stop_token&) {
    const auto here = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0)) / page * page;
    looked = mincore(reinterpret_cast<void*>(here - kUsed), kUsed, resident.data());
  }));
  thread.join();
  ASSERT_EQ(looked, 0);
  EXPECT_EQ(std::count_if(resident.begin(), resident.end(), [](unsigned char at) { return (at & 1U) == 0; }),
            0)
      << "pages of the stack below what the thread uses";
}

TEST(RtThread, FlushesSubnormals) {
  volatile float smallest = std::numeric_limits<float>::min();
  float half = 1.0F;
  RtThread thread;
  ASSERT_TRUE(thread.start({"sched", 0, {}}, [&](const std::stop_token&) { half = smallest * 0.5F; }));
  thread.join();
  EXPECT_EQ(half, 0.0F);
}

TEST(RtThread, TellsItsKernelThreadId) {
  const ShortLife run({"rx", 0, {}});
  EXPECT_EQ(run.tid, run.seen.tid);
  EXPECT_NE(run.tid, getpid());
}

TEST(RtThread, JoinAsksTheBodyToStopAndWaitsForIt) {
  RtThread thread;
  bool ended = false;
  ASSERT_TRUE(thread.start({"link", 0, {}}, [&](const std::stop_token& stop) {
    std::promise<void> asked;
    const std::stop_callback callback(stop, [&] { asked.set_value(); });
    asked.get_future().wait();
    ended = true;
  }));
  EXPECT_TRUE(thread.joinable());
  thread.join();
  EXPECT_TRUE(ended);
  EXPECT_FALSE(thread.joinable());
  thread.join();  // harmless
}

TEST(RtThread, ItsDestructorJoins) {
  bool ended = false;
  {
    RtThread thread;
    ASSERT_TRUE(thread.start({"link", 0, {}}, [&](const std::stop_token& stop) {
      std::promise<void> asked;
      const std::stop_callback callback(stop, [&] { asked.set_value(); });
      asked.get_future().wait();
      ended = true;
    }));
  }
  EXPECT_TRUE(ended);
}

TEST(RtThread, OneThatWasNeverStartedIsJoinedAtOnce) {
  RtThread thread;
  EXPECT_FALSE(thread.joinable());
  thread.join();
}

}  // namespace
}  // namespace rc10::test::rt_thread_test
