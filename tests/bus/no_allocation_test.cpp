// The real-time threads allocate nothing: no malloc, no mmap.

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <new>

#include "bus/can_receiver.hpp"
#include "bus/fake_devices.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/socket_pair.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::no_allocation_test {
namespace {

TEST(AllocGuard, CountsWhatIsAllocatedWhileItLives) {
  const auto before = std::make_unique<int>(1);
  const AllocGuard guard;
  EXPECT_EQ(guard.allocations(), 0U);
  // volatile: the compiler may leave out a pair of new and delete
  void* volatile memory = ::operator new(100);
  ::operator delete(memory);
  EXPECT_EQ(guard.allocations(), 1U);
  memory = ::operator new[](100, std::align_val_t{64});
  ::operator delete[](memory, std::align_val_t{64});
  EXPECT_EQ(guard.allocations(), 2U);
}

TEST(AllocGuard, CountsTheCLibraryToo) {
  if (!AllocGuard::countsMalloc()) return;  // under a sanitizer: operator new only
  const AllocGuard guard;
  void* volatile memory = std::malloc(10);
  memory = std::realloc(memory, 100);
  std::free(memory);
  memory = std::calloc(3, 3);
  std::free(memory);
  memory = std::aligned_alloc(64, 64);
  std::free(memory);
  EXPECT_EQ(guard.allocations(), 4U);
  memory = ::mmap(nullptr, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  ::munmap(memory, 4096);
  EXPECT_EQ(guard.allocations(), 5U);
}

class NoAllocationTest : public testing::Test {
 protected:
  NoAllocationTest() {
    EXPECT_TRUE(bus_->registerMotor(standard_));
    EXPECT_TRUE(bus_->registerMotor(masked_));
    EXPECT_TRUE(bus_->registerMotor(damiao_));
    EXPECT_TRUE(bus_->registerMotor(classic_packer_));
    EXPECT_TRUE(bus_->registerMotor(fd_packer_));
    fd_packer_.fd = true;
  }

  void tick() {
    bus_->packCommands({});
    bus_->flush();
  }

  SocketPair pair_;
  int near_ = pair_.near.get();
  std::unique_ptr<fdCANbus> bus_ = fdCANbus::adopt("bus", std::move(pair_.near), true);
  FakeDevice standard_{"standard", {standardFilter(0x201)}};
  FakeDevice masked_{"masked", {robStrideFilter(1)}};
  FakeDevice damiao_{"damiao", {damiaoFilter(0x11, 1)}};
  FakePacker classic_packer_{"classic", {0x200, false}, 4};
  FakePacker fd_packer_{"fd", {0x8001, true}, 4};
};

TEST_F(NoAllocationTest, DispatchAllocatesNothing) {
  CanFrame error = makeClassicFrame({0x40, false}, std::array<std::uint8_t, 8>{});
  error.type = FrameType::kError;
  const std::array frames{makeClassicFrame({0x201, false}, {}),
                          makeClassicFrame({0x0280'01FD, true}, {}),
                          makeClassicFrame({0x11, false}, std::array<std::uint8_t, 1>{1}),
                          makeClassicFrame({0x7FF, false}, {}),
                          makeClassicFrame({0x7FF, true}, {}),
                          error};
  const AllocGuard guard;
  for (const CanFrame& frame : frames) bus_->dispatch(frame);
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_EQ(standard_.received + masked_.received + damiao_.received, 3);
}

TEST_F(NoAllocationTest, PackingAndSendingAllocateNothing) {
  {
    const AllocGuard guard;
    tick();
    bus_->packRest();
    bus_->flush();
    EXPECT_EQ(guard.allocations(), 0U);
  }
  EXPECT_EQ(pair_.read().size(), 10U);
}

TEST_F(NoAllocationTest, RefusalAllocatesNothing) {
  const int minimum = 1;
  ASSERT_EQ(::setsockopt(near_, SOL_SOCKET, SO_SNDBUF, &minimum, sizeof(minimum)), 0);
  const AllocGuard guard;
  for (int i = 0; i < 20; ++i) tick();
  for (std::size_t i = 0; i <= fdCANbus::kMaxFramesPerTick; ++i) {
    (void)bus_->sendFrame(makeClassicFrame({0x300, false}, {}));
  }
  bus_->flush();
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_GT(bus_->counters().tx_dropped, 0U);
}

TEST_F(NoAllocationTest, ReceivingAllocatesNothing) {
  const int on = 1;
  ASSERT_EQ(::setsockopt(near_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)), 0);
  CanReceiver receiver(near_);
  std::array<CanFrame, CanReceiver::kBatch> out{};
  for (int i = 0; i < 10; ++i) pair_.write(makeClassicFrame({0x201, false}, {}));
  pair_.write("odd", 3);
  const AllocGuard guard;
  EXPECT_EQ(receiver.receive({}, out).frame_count, 10U);
  EXPECT_EQ(receiver.receive({}, out).frame_count, 0U);
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(NoAllocationTest, HealthAllocatesNothing) {
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) {
    bus_->health().update(MonotonicTime{std::chrono::milliseconds(i)},
                          {.echo_reads = static_cast<std::uint64_t>(i)});
  }
  bus_->health().onLink(CanLinkState::kGone);
  EXPECT_EQ(bus_->health().state(), BusState::kGone);
  EXPECT_EQ(guard.allocations(), 0U);
}

}  // namespace
}  // namespace rc10::test::no_allocation_test
