#include "rc10/rtos_queue.hpp"

#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace rtos_queue_test {
namespace {

using namespace std::chrono_literals;

TEST(RtosQueue, KeepsTheOrder) {
  RtosQueue<int> queue(3);
  for (int round = 0; round < 5; ++round) {
    EXPECT_TRUE(queue.trySend(1));
    EXPECT_TRUE(queue.trySend(2));
    EXPECT_EQ(queue.tryReceive(), 1);
    EXPECT_EQ(queue.tryReceive(), 2);
  }
  EXPECT_EQ(queue.tryReceive(), std::nullopt);
}

TEST(RtosQueue, IsBounded) {
  RtosQueue<int> queue(2);
  EXPECT_TRUE(queue.trySend(1));
  EXPECT_TRUE(queue.send(2, 0ms));
  EXPECT_FALSE(queue.trySend(3));
  EXPECT_FALSE(queue.send(3, 1ms));
  EXPECT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue.capacity(), 2U);
}

TEST(RtosQueue, ReceivingWaitsNoLongerThanAsked) {
  RtosQueue<int> queue;
  EXPECT_EQ(queue.receive(1ms), std::nullopt);
  EXPECT_EQ(queue.receive(-1ms), std::nullopt);
}

TEST(RtosQueue, AWaitingReceiverIsWoken) {
  RtosQueue<int> queue;
  std::thread sender([&] { EXPECT_TRUE(queue.trySend(7)); });
  EXPECT_EQ(queue.receive(Duration::max()), 7);
  sender.join();
}

TEST(RtosQueue, AWaitingSenderIsWoken) {
  RtosQueue<int> queue(1);
  EXPECT_TRUE(queue.trySend(1));
  std::thread sender([&] { EXPECT_TRUE(queue.send(2, 1h)); });
  EXPECT_EQ(queue.receive(1h), 1);
  EXPECT_EQ(queue.receive(1h), 2);
  sender.join();
}

TEST(RtosQueue, MovesWhatCannotBeCopied) {
  RtosQueue<std::unique_ptr<int>> queue;
  EXPECT_TRUE(queue.trySend(std::make_unique<int>(5)));
  EXPECT_EQ(**queue.tryReceive(), 5);
}

TEST(RtosQueue, LosesAndDoublesNothingBetweenThreads) {
  RtosQueue<int> queue(4);
  constexpr int kEach = 5000;
  std::atomic<long> sum{0};
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 2; ++t) {
      threads.emplace_back([&] {
        for (int i = 1; i <= kEach; ++i) ASSERT_TRUE(queue.send(i, 1h));
      });
      threads.emplace_back([&] {
        for (int i = 0; i < kEach; ++i) sum += *queue.receive(1h);
      });
    }
  }
  EXPECT_EQ(sum, 2L * kEach * (kEach + 1) / 2);
  EXPECT_EQ(queue.size(), 0U);
}

}  // namespace
}  // namespace rtos_queue_test
}  // namespace robot_client
}  // namespace rc10
