#include "rc10/rtos_task.hpp"

#include <pthread.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace rtos_task_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr MonotonicTime kStart{1000s};

TEST(Rate, StepsOnTheGridWhateverTheBodyTakes) {
  const auto next = Rate::next(kStart, 10ms, kStart + 7ms);
  EXPECT_EQ(next.due, kStart + 10ms);
  EXPECT_EQ(next.missed, 0U);
}

TEST(Rate, SkipsWhatWasMissedAndCountsIt) {
  const auto next = Rate::next(kStart, 10ms, kStart + 35ms);
  EXPECT_EQ(next.due, kStart + 40ms);
  EXPECT_EQ(next.missed, 3U);
  EXPECT_EQ(Rate::next(kStart, 10ms, kStart + 40ms).due, kStart + 40ms);
}

TEST(RtosTask, CallsLoopAgainAndAgainUnderItsName) {
  RtosTask task({.name = "a-name-that-is-too-long"});
  std::promise<std::string> name;
  std::atomic<int> calls{0};
  ASSERT_TRUE(task.startLoop(1ms, [&] {
    if (++calls != 3) return;
    std::array<char, 16> text{};
    pthread_getname_np(pthread_self(), text.data(), text.size());
    name.set_value(text.data());
  }));
  EXPECT_EQ(name.get_future().get(), "a-name-that-is-");
  task.stop();
  EXPECT_GE(task.cycles(), 3U);
  EXPECT_FALSE(task.running());
}

TEST(RtosTask, CountsOverruns) {
  RtosTask task({.name = "late"});
  std::promise<void> late;
  int calls = 0;
  ASSERT_TRUE(task.startLoop(1ms, [&] {
    if (++calls == 1) {
      const auto end = std::chrono::steady_clock::now() + 5ms;
      while (std::chrono::steady_clock::now() < end) {
      }
    }
    if (calls == 2) late.set_value();
  }));
  late.get_future().wait();
  task.stop();
  EXPECT_GE(task.overruns(), 3U);
}

TEST(RtosTask, RunEndsWhenItIsAskedTo) {
  RtosTask task({.name = "waiter"});
  std::promise<void> begun;
  ASSERT_TRUE(task.startRun([&](const std::stop_token& stop) {
    begun.set_value();
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    changed.wait(lock, stop, [] { return false; });
  }));
  begun.get_future().wait();
  EXPECT_TRUE(task.running());
  EXPECT_FALSE(task.startRun([](const std::stop_token&) {})) << "it runs already";
  task.stop();
  EXPECT_FALSE(task.running());
}

class Derived : public RtosTask {
 public:
  Derived() : RtosTask({.name = "derived"}) {}
  ~Derived() override { stop(); }
  std::promise<void> looped;
  std::promise<void> ran;

 protected:
  void loop() override {
    if (cycles() == 0) looped.set_value();
  }
  void run(std::stop_token) override { ran.set_value(); }
};

TEST(RtosTask, MayBeDerivedFrom) {
  Derived task;
  ASSERT_TRUE(task.start(1ms));
  task.looped.get_future().wait();
  task.stop();
  ASSERT_TRUE(task.start());
  task.ran.get_future().wait();
}

TEST(RtosTask, WhatIsNotGrantedIsToldAndDoesNotStopIt) {
  RtosTask task({.name = "pinned", .cpu = 4000});
  std::promise<void> ran;
  ASSERT_TRUE(task.startRun([&](const std::stop_token&) { ran.set_value(); }));
  ran.get_future().wait();
  EXPECT_THAT(task.problem(), HasSubstr("task pinned: CPU 4000 was refused"));
}

TEST(RtosTask, WhatIsRequiredAndNotGrantedIsAnError) {
  RtosTask task({.name = "fifo", .policy = SchedPolicy::kFifo, .priority = 200, .required = true});
  const auto started = task.startRun([](const std::stop_token&) { ADD_FAILURE() << "it ran"; });
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("SCHED_FIFO 200 was refused: a priority is within 1 to 99"));
  EXPECT_FALSE(task.running());
}

TEST(RtosTask, IsRealTimeOrSaysWhyNot) {
  RtosTask task({.name = "fifo", .policy = SchedPolicy::kFifo, .priority = 5});
  std::promise<int> policy;
  ASSERT_TRUE(task.startRun([&](const std::stop_token&) {
    int mine = 0;
    sched_param param{};
    pthread_getschedparam(pthread_self(), &mine, &param);
    policy.set_value(mine);
  }));
  if (policy.get_future().get() == SCHED_FIFO) {
    EXPECT_EQ(task.problem(), "");
  } else {
    EXPECT_THAT(task.problem(), HasSubstr("LimitRTPRIO=5"));
  }
}

}  // namespace
}  // namespace rtos_task_test
}  // namespace robot_client
}  // namespace rc10
