#include "bus/echo_counter.hpp"

#include <gtest/gtest.h>

#include "bus/socket_pair.hpp"
#include "support/alloc_guard.hpp"
#include "support/frame_calls.hpp"

namespace rc10::test::echo_counter_test {
namespace {

class EchoCounterTest : public ::testing::Test {
 protected:
  ~EchoCounterTest() override { frameCalls() = {}; }
  void write(std::uint8_t count) {
    for (std::uint8_t i = 0; i < count; ++i) pair.write(numbered(i));
  }

  SocketPair pair;
  EchoCounter counter{pair.near.get()};
};

TEST_F(EchoCounterTest, CountsWhatWasSentOnThisComputer) {
  frameCalls().received = [n = 0](msghdr& message) mutable {
    if (n++ != 1) message.msg_flags |= MSG_DONTROUTE;
  };
  write(3);
  const auto count = counter.take();
  EXPECT_EQ(count.messages, 3U);
  EXPECT_EQ(count.confirmed, 2U) << "another computer's command is no echo";
  EXPECT_EQ(counter.take().messages, 0U);
}

TEST_F(EchoCounterTest, TakesABatchInOneCall) {
  frameCalls().received = [](msghdr& message) { message.msg_flags |= MSG_DONTROUTE; };
  write(EchoCounter::kBatch + 1);
  const AllocGuard guard;
  EXPECT_EQ(counter.take().confirmed, EchoCounter::kBatch);
  EXPECT_EQ(counter.take().confirmed, 1U) << "flags of an earlier call do not count";
  EXPECT_EQ(frameCalls().recvmmsg, 2U);
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(EchoCounterTest, AClosedSocketHasNoEchoes) {
  pair.far.reset();
  EXPECT_EQ(counter.take().confirmed, 0U);
}

}  // namespace
}  // namespace rc10::test::echo_counter_test
