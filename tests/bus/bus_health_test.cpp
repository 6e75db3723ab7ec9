#include "bus/bus_health.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <array>

namespace rc10::test::bus_health_test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kCounters = 0x200;  // CAN_ERR_CNT

CanFrame errorFrame(std::uint32_t classes, std::uint8_t crtl = 0, std::uint8_t tec = 0,
                    std::uint8_t rec = 0) {
  CanFrame frame = makeClassicFrame({}, std::array<std::uint8_t, 8>{0, crtl, 0, 0, 0, 0, tec, rec});
  frame.type = FrameType::kError;
  frame.id = {classes, false};
  return frame;
}

/// A bus in virtual time that talks, sends and is echoed unless told otherwise.
class BusHealthTest : public testing::Test {
 protected:
  void run(Duration time) {
    for (const MonotonicTime end = now_ + time; now_ < end;) {
      now_ += 1ms;
      if (hears_) ++traffic_.rx_frames;
      if (sends_) ++traffic_.tx_watched;
      if (sends_ || others_) ++traffic_.tx_frames;
      if (sends_ && echoes_) ++traffic_.tx_confirmed;
      if (reads_) ++traffic_.echo_reads;
      health_.update(now_, traffic_);
    }
  }

  BusState state() const { return health_.state(); }

  BusHealth health_;
  BusHealth::Traffic traffic_{.echo_reads = 1};
  MonotonicTime now_{1000s};
  bool hears_ = true;
  bool sends_ = true;
  bool others_ = false;  // frames that are not watched, taken by the kernel
  bool echoes_ = true;
  bool reads_ = true;
};

TEST_F(BusHealthTest, IsActiveWhileItTalksAndIsEchoed) {
  run(1s);
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.transmitErrors(), -1);
  EXPECT_EQ(health_.receiveErrors(), -1);
  EXPECT_EQ(health_.errorFrames(), 0U);
}

TEST_F(BusHealthTest, FollowsTheControllerFromWarningToPassiveAndBack) {
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL | kCounters, CAN_ERR_CRTL_RX_WARNING, 3, 97));
  EXPECT_EQ(state(), BusState::kWarning);
  EXPECT_EQ(health_.transmitErrors(), 3);
  EXPECT_EQ(health_.receiveErrors(), 97);
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL | kCounters, CAN_ERR_CRTL_TX_PASSIVE, 136, 0));
  EXPECT_EQ(state(), BusState::kPassive);
  EXPECT_EQ(health_.transmitErrors(), 136);
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL | kCounters, CAN_ERR_CRTL_TX_WARNING, 120, 0));
  EXPECT_EQ(state(), BusState::kWarning);
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL | kCounters, 0x40, 95, 0));
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.transmitErrors(), 95);
  EXPECT_EQ(health_.errorFrames(), 4U);
  EXPECT_EQ(health_.restarts(), 0U);
}

TEST_F(BusHealthTest, ADriverThatSaysTheControllerRunsEndsBusOffAndNothingElse) {
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL | kCounters, CAN_ERR_CRTL_TX_PASSIVE, 136, 0));
  health_.onControllerRunning();
  EXPECT_EQ(state(), BusState::kPassive);
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSOFF));
  health_.onControllerRunning();
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.restarts(), 1U);
}

TEST_F(BusHealthTest, ATickThatComesLateIsNoStall) {
  run(10ms);
  echoes_ = false;
  run(1ms);
  now_ += 500ms;  // the whole computer slept
  run(1ms);
  echoes_ = true;
  run(10ms);
  EXPECT_EQ(state(), BusState::kActive);
  echoes_ = false;
  run(10ms);
  EXPECT_EQ(state(), BusState::kStalled);
}

TEST_F(BusHealthTest, PassiveWinsOverWarningInOneMessage) {
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_PASSIVE));
  EXPECT_EQ(state(), BusState::kPassive);
}

TEST_F(BusHealthTest, TakesCountersThatAnOldKernelDoesNotAnnounce) {
  // The frame of TESTING: `cansend vcan0 20000004#0020000000008800`.
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, 136, 0));
  EXPECT_EQ(health_.transmitErrors(), 136);
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL, 0x40));
  EXPECT_EQ(health_.transmitErrors(), -1);
}

TEST_F(BusHealthTest, AnOverflowOfTheControllerIsCountedAndChangesNothing) {
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL | kCounters, CAN_ERR_CRTL_TX_PASSIVE, 130, 2));
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW));
  EXPECT_EQ(state(), BusState::kPassive);
  EXPECT_EQ(health_.transmitErrors(), 130);
  EXPECT_EQ(health_.errorFrames(), 2U);
}

TEST_F(BusHealthTest, ABusErrorWithCountersUpdatesThemAlone) {
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSERROR | CAN_ERR_PROT | kCounters, 0, 40, 50));
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.transmitErrors(), 40);
  EXPECT_EQ(health_.receiveErrors(), 50);
}

TEST_F(BusHealthTest, BytesOfOtherClassesAreNotReadAsControllerState) {
  // data[1] belongs to the class CRTL.
  health_.onErrorFrame(errorFrame(CAN_ERR_TX_TIMEOUT, CAN_ERR_CRTL_TX_PASSIVE, 7, 7));
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.transmitErrors(), -1);
}

TEST_F(BusHealthTest, BusOffLastsUntilTheRestart) {
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSOFF));
  EXPECT_EQ(state(), BusState::kBusOff);
  EXPECT_EQ(health_.transmitErrors(), -1);
  run(1s);
  EXPECT_EQ(state(), BusState::kBusOff);
  health_.onErrorFrame(errorFrame(CAN_ERR_RESTARTED));
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.restarts(), 1U);
}

TEST_F(BusHealthTest, BusOffWinsOverTheStateThatComesWithIt) {
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSOFF | CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE));
  EXPECT_EQ(state(), BusState::kBusOff);
}

TEST_F(BusHealthTest, AnyOtherStateProvesThatBusOffIsOver) {
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSOFF));
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING));
  EXPECT_EQ(state(), BusState::kWarning);
  EXPECT_EQ(health_.restarts(), 1U);
}

TEST_F(BusHealthTest, ARestartWhoseBusOffWasLostIsCounted) {
  health_.onErrorFrame(errorFrame(CAN_ERR_RESTARTED));
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.restarts(), 1U);
}

TEST_F(BusHealthTest, CyclingTheLinkEndsBusOffAndIsOneRestart) {
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSOFF));
  health_.onLink(CanLinkState::kDown);
  EXPECT_EQ(state(), BusState::kDown);
  EXPECT_EQ(health_.restarts(), 0U);
  health_.onLink(CanLinkState::kUp);
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.restarts(), 1U);
}

TEST_F(BusHealthTest, AnInterfaceThatComesBackFromGoneIsOneRestart) {
  health_.onLink(CanLinkState::kDown);
  health_.onLink(CanLinkState::kGone);
  EXPECT_EQ(state(), BusState::kGone);
  health_.onLink(CanLinkState::kDown);
  EXPECT_EQ(state(), BusState::kDown);
  health_.onLink(CanLinkState::kUp);
  health_.onLink(CanLinkState::kUp);
  EXPECT_EQ(state(), BusState::kActive);
  EXPECT_EQ(health_.restarts(), 1U);
}

TEST_F(BusHealthTest, IsSilentWhenNothingIsHeardForTheTimeSet) {
  run(50ms);
  hears_ = false;
  run(99ms);
  EXPECT_EQ(state(), BusState::kActive);
  run(1ms);
  EXPECT_EQ(state(), BusState::kSilent);
  hears_ = true;
  run(1ms);
  EXPECT_EQ(state(), BusState::kActive);
}

TEST_F(BusHealthTest, IsSilentFromTheStartWhenTheMotorsHaveNoPower) {
  hears_ = false;
  run(101ms);
  EXPECT_EQ(state(), BusState::kSilent);
}

TEST_F(BusHealthTest, IsNotSilentWhereNobodyTalksUnasked) {
  hears_ = false;
  traffic_.feedback_expected = false;
  run(1s);
  EXPECT_EQ(state(), BusState::kActive);
  traffic_.feedback_expected = true;
  run(99ms);
  EXPECT_EQ(state(), BusState::kActive);
  run(1ms);
  EXPECT_EQ(state(), BusState::kSilent);
}

TEST_F(BusHealthTest, IsStalledWhenNoEchoComesForFiveTicks) {
  run(50ms);
  echoes_ = false;
  run(5ms);
  EXPECT_EQ(state(), BusState::kActive);
  run(1ms);
  EXPECT_EQ(state(), BusState::kStalled);
}

TEST_F(BusHealthTest, TheJitterOfTicksDoesNotMakeThemSix) {
  run(50ms);
  echoes_ = false;
  now_ += 100us;  // the tick that begins to wait is late
  run(1ms);
  now_ -= 100us;
  run(4ms);
  EXPECT_EQ(state(), BusState::kActive);
  run(1ms);
  EXPECT_EQ(state(), BusState::kStalled);
}

TEST_F(BusHealthTest, ASlowCommanderIsStalledToo) {
  run(50ms);
  sends_ = false;
  run(20ms);
  EXPECT_EQ(state(), BusState::kActive);
  ++traffic_.tx_watched;  // one frame, without echo
  run(5ms);
  EXPECT_EQ(state(), BusState::kActive);
  run(1ms);
  EXPECT_EQ(state(), BusState::kStalled);
}

TEST_F(BusHealthTest, AQueueThatStaysFullIsAStall) {
  run(50ms);
  sends_ = false;
  ++traffic_.tx_refused;
  run(6ms);
  EXPECT_EQ(state(), BusState::kStalled);
  others_ = true;  // probes of a stalled bus: only an echo ends it
  run(6ms);
  EXPECT_EQ(state(), BusState::kStalled);
}

TEST_F(BusHealthTest, ARefusedFrameOfASlowCommanderIsNoStallWhereOthersAreTakenAgain) {
  run(50ms);
  sends_ = false;
  ++traffic_.tx_refused;  // the queue was full when its turn came; the next is ten ticks away
  run(2ms);
  others_ = true;
  run(8ms);
  EXPECT_EQ(state(), BusState::kActive);
  others_ = false;
  ++traffic_.tx_watched;
  ++traffic_.tx_frames;
  run(6ms);
  EXPECT_EQ(state(), BusState::kStalled) << "taken, and not echoed";
}

TEST_F(BusHealthTest, FramesLostLongAgoDoNotStallABusThatEchoesAgain) {
  run(50ms);
  echoes_ = false;
  run(3ms);  // bus-off swallows what the kernel accepted: these echoes never come
  echoes_ = true;
  run(1s);
  EXPECT_EQ(state(), BusState::kActive);
}

TEST_F(BusHealthTest, EchoesThatNobodyHasReadAreNoStall) {
  run(10ms);
  echoes_ = reads_ = false;  // the RX thread has no CPU
  run(100ms);
  EXPECT_EQ(state(), BusState::kActive);
  reads_ = true;
  run(10ms);
  EXPECT_EQ(state(), BusState::kStalled);
}

TEST_F(BusHealthTest, StaysStalledWhileNothingIsSentAndRevivesWithAnEcho) {
  run(50ms);
  echoes_ = false;
  run(10ms);
  sends_ = false;
  run(1s);
  EXPECT_EQ(state(), BusState::kStalled);
  ++traffic_.tx_confirmed;
  run(1ms);
  EXPECT_EQ(state(), BusState::kActive);
}

TEST_F(BusHealthTest, CyclingTheLinkEndsAStall) {
  run(50ms);
  echoes_ = false;
  run(10ms);
  EXPECT_EQ(state(), BusState::kStalled);
  sends_ = false;
  health_.onLink(CanLinkState::kDown);
  run(10ms);
  health_.onLink(CanLinkState::kUp);
  run(10ms);
  EXPECT_EQ(state(), BusState::kActive);
}

TEST_F(BusHealthTest, IsNeverStalledWithoutAnEchoSocket) {
  traffic_.echo_reads = 0;
  echoes_ = reads_ = false;
  run(1s);
  EXPECT_EQ(state(), BusState::kActive);
}

TEST_F(BusHealthTest, ReportsTheMostSeriousOfWhatIsTrue) {
  health_.onErrorFrame(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE));
  run(50ms);
  EXPECT_EQ(state(), BusState::kPassive);
  hears_ = false;
  run(200ms);
  EXPECT_EQ(state(), BusState::kSilent);
  echoes_ = false;
  run(10ms);
  EXPECT_EQ(state(), BusState::kStalled);
  health_.onErrorFrame(errorFrame(CAN_ERR_BUSOFF));
  EXPECT_EQ(state(), BusState::kBusOff);
  health_.onLink(CanLinkState::kDown);
  EXPECT_EQ(state(), BusState::kDown);
  health_.onLink(CanLinkState::kGone);
  EXPECT_EQ(state(), BusState::kGone);
}

TEST_F(BusHealthTest, ABusThatComesBackGetsTheWholeTimeAgain) {
  run(50ms);
  hears_ = false;
  echoes_ = false;
  health_.onLink(CanLinkState::kDown);
  run(10s);
  health_.onLink(CanLinkState::kUp);
  sends_ = false;
  run(99ms);
  EXPECT_EQ(state(), BusState::kActive);
  run(1ms);
  EXPECT_EQ(state(), BusState::kSilent);
}

TEST_F(BusHealthTest, TheTimesAreConfigurable) {
  health_ = BusHealth(BusHealth::Config{.silent_after = 10ms, .stalled_after = 2ms, .stalled_ticks = 2});
  run(5ms);
  echoes_ = false;
  run(3ms);
  EXPECT_EQ(state(), BusState::kStalled);
  echoes_ = true;
  hears_ = false;
  run(11ms);
  EXPECT_EQ(state(), BusState::kSilent);
}

}  // namespace
}  // namespace rc10::test::bus_health_test
