#include "bus/control_messages.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>

namespace rc10::test::control_messages_test {
namespace {

using namespace std::chrono_literals;

// Control data as recvmmsg writes it.
class Control {
 public:
  Control() {
    message_.msg_control = bytes_.data();
    message_.msg_controllen = bytes_.size();
    next_ = CMSG_FIRSTHDR(&message_);
    message_.msg_controllen = 0;
  }

  template <typename T>
  Control& add(int level, int type, const T& value) {
    message_.msg_controllen += CMSG_SPACE(sizeof(T));
    next_->cmsg_level = level;
    next_->cmsg_type = type;
    next_->cmsg_len = CMSG_LEN(sizeof(T));
    std::memcpy(CMSG_DATA(next_), &value, sizeof(T));
    next_ = reinterpret_cast<cmsghdr*>(bytes_.data() + message_.msg_controllen);
    return *this;
  }

  [[nodiscard]] ControlMessages read() const { return readControlMessages(message_); }

 private:
  alignas(cmsghdr) std::array<std::byte, 256> bytes_{};
  msghdr message_{};
  cmsghdr* next_ = nullptr;
};

TEST(ControlMessages, MayBeAbsent) {
  const ControlMessages read = Control().read();
  EXPECT_FALSE(read.realtime_stamp);
  EXPECT_FALSE(read.kernel_dropped);
}

TEST(ControlMessages, CarryTheReceiveStamp) {
  const ControlMessages read = Control().add(SOL_SOCKET, SCM_TIMESTAMPNS, timespec{1'767'225'600, 7}).read();
  EXPECT_EQ(read.realtime_stamp, Duration{1'767'225'600s + 7ns});
  EXPECT_FALSE(read.kernel_dropped);
}

TEST(ControlMessages, CarryTheCountOfFramesThatTheKernelDropped) {
  const ControlMessages read = Control()
                                   .add(SOL_SOCKET, SCM_TIMESTAMPNS, timespec{1, 0})
                                   .add(SOL_SOCKET, SO_RXQ_OVFL, std::uint32_t{4'000'000'000})
                                   .read();
  EXPECT_EQ(read.realtime_stamp, Duration{1s});
  EXPECT_EQ(read.kernel_dropped, 4'000'000'000U);
}

TEST(ControlMessages, OfAnotherLevelOrTypeAreSkipped) {
  const ControlMessages read = Control()
                                   .add(SOL_SOCKET + 1, SCM_TIMESTAMPNS, timespec{9, 0})
                                   .add(SOL_SOCKET, SCM_CREDENTIALS, std::uint64_t{9})
                                   .add(SOL_SOCKET, SO_RXQ_OVFL, std::uint32_t{3})
                                   .read();
  EXPECT_FALSE(read.realtime_stamp);
  EXPECT_EQ(read.kernel_dropped, 3U);
}

TEST(ControlMessages, TooShortForTheirContentAreSkipped) {
  EXPECT_FALSE(Control().add(SOL_SOCKET, SCM_TIMESTAMPNS, std::uint32_t{1}).read().realtime_stamp);
}

TEST(ControlMessages, BothFitIntoTheRoomThatAReceiverOffers) {
  EXPECT_GE(kControlBytes, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t)));
}

}  // namespace
}  // namespace rc10::test::control_messages_test
