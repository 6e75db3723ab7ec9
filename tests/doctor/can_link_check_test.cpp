#include "doctor/can_link_check.hpp"

#include <gmock/gmock.h>
#include <linux/can/netlink.h>

namespace rc10::doctor::link_check_test {
namespace {

using ::testing::HasSubstr;

CanLinkFacts good() {
  CanLink link;
  link.up = true;
  link.is_can = true;
  link.kind = "can";
  link.bitrate = 1'000'000;
  link.sample_point = 0.8;
  link.state = CanState::kActive;
  link.tec = 0;
  link.rec = 0;
  link.queue_length = 10;
  link.qdisc = "pfifo_fast";
  CanLinkFacts facts;
  facts.interface = "can0";
  facts.link = link;
  facts.driver = "mcp251xfd";
  facts.coalescing = Coalescing{};
  facts.wanted.bitrate = 1'000'000;
  return facts;
}

TEST(CanLinkCheck, AnInterfaceThatIsAsItShouldBePassesEverything) {
  for (const auto& finding : checkCanLink(good()))
    EXPECT_EQ(finding.verdict, Verdict::kPass) << finding.what << ": " << finding.why;
}

TEST(CanLinkCheck, AnInterfaceThatIsNotThereIsOneFailure) {
  auto facts = good();
  facts.link.reset();
  const auto findings = checkCanLink(facts);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].verdict, Verdict::kFail);
}

TEST(CanLinkCheck, DownFailsUnlessRc10dBringsItUp) {
  auto facts = good();
  facts.link->up = false;
  EXPECT_EQ(checkUp(facts).verdict, Verdict::kFail);
  EXPECT_THAT(checkUp(facts).fix, HasSubstr("ip link set can0 up type can bitrate 1000000"));
  facts.managed = true;
  EXPECT_EQ(checkUp(facts).verdict, Verdict::kPass);
}

TEST(CanLinkCheck, SomethingElseThanCanIsTold) {
  auto facts = good();
  facts.link->is_can = false;
  EXPECT_EQ(worst(checkCanLink(facts)), Verdict::kFail);
}

TEST(CanLinkCheck, AnotherBitRateFails) {
  auto facts = good();
  facts.wanted.bitrate = 500'000;
  EXPECT_EQ(checkBitrate(facts).verdict, Verdict::kFail);
  EXPECT_THAT(checkBitrate(facts).fix, HasSubstr("bitrate 500000"));
  facts.wanted.bitrate = 0;
  EXPECT_EQ(checkBitrate(facts).verdict, Verdict::kPass);
  facts.link->bitrate.reset();
  EXPECT_EQ(checkBitrate(facts).verdict, Verdict::kFail);
}

TEST(CanLinkCheck, ASamplePointFarOutIsAWarning) {
  auto facts = good();
  facts.link->sample_point = 0.5;
  EXPECT_EQ(checkSamplePoint(facts).verdict, Verdict::kWarn);
  facts.link->sample_point = 0.875;
  EXPECT_EQ(checkSamplePoint(facts).verdict, Verdict::kPass);
  EXPECT_THAT(checkSamplePoint(facts).why, HasSubstr("87.5 %"));
}

TEST(CanLinkCheck, FdHasToBeAsConfigured) {
  auto facts = good();
  facts.wanted.data_bitrate = 5'000'000;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kFail);
  EXPECT_THAT(checkFdMode(facts).fix, HasSubstr("dbitrate 5000000"));
  facts.link->fd_on = true;
  facts.link->data_bitrate = 2'000'000;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kFail);
  facts.link->data_bitrate = 5'000'000;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kPass);
  facts.wanted.data_bitrate = 0;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kWarn);
  EXPECT_THAT(checkFdMode(facts).fix, HasSubstr("fd off"));
}

TEST(CanLinkCheck, AConfiguredSamplePointIsCompared) {
  auto facts = good();
  facts.wanted.sample_point = 0.666;
  EXPECT_EQ(checkSamplePoint(facts).verdict, Verdict::kFail);
  EXPECT_THAT(checkSamplePoint(facts).fix, HasSubstr("bitrate 1000000 sample-point 0.666 restart-ms 0"));
  facts.link->sample_point = 0.65;
  EXPECT_EQ(checkSamplePoint(facts).verdict, Verdict::kPass) << "somebody wanted it that early";
}

TEST(CanLinkCheck, WhatRc10dMendsIsNoFault) {
  auto facts = good();
  facts.managed = true;
  facts.wanted.data_bitrate = 5'000'000;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kPass);
  EXPECT_THAT(checkFdMode(facts).why, HasSubstr("rc10d mends it"));
  facts.link->fd_on = true;
  facts.link->data_bitrate = 2'000'000;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kPass);
  facts.wanted.data_bitrate = 0;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kPass);
  facts.link->modes = CAN_CTRLMODE_LISTENONLY;
  EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kPass);
}

TEST(CanLinkCheck, ItSaysWhatRc10dSays) {
  for (const bool fd_on : {false, true}) {
    for (const bool wants_fd : {false, true}) {
      auto facts = good();
      facts.link->fd_on = fd_on;
      if (fd_on) facts.link->data_bitrate = 5'000'000;
      if (wants_fd) facts.wanted.data_bitrate = 5'000'000;
      const bool wrong = !wrongSetting("can0", *facts.link, facts.wanted).empty();
      EXPECT_EQ(checkFdMode(facts).verdict != Verdict::kPass, wrong);
      EXPECT_EQ(setupCommand(facts), restartCommand("can0", *facts.link, facts.wanted, "sudo "));
    }
  }
}

TEST(CanLinkCheck, AControllerThatCannotSendFails) {
  auto facts = good();
  for (const auto mode : {CAN_CTRLMODE_LISTENONLY, CAN_CTRLMODE_LOOPBACK, CAN_CTRLMODE_ONE_SHOT}) {
    facts.link->modes = static_cast<std::uint32_t>(mode);
    EXPECT_EQ(checkFdMode(facts).verdict, Verdict::kFail);
  }
}

TEST(CanLinkCheck, AnAutomaticRestartFails) {
  auto facts = good();
  facts.link->restart_ms = 100;
  EXPECT_EQ(checkRestart(facts).verdict, Verdict::kFail);
  EXPECT_THAT(checkRestart(facts).fix, HasSubstr("restart-ms 0"));
}

TEST(CanLinkCheck, TheSendQueueIsShortAndKeepsOrder) {
  auto facts = good();
  facts.link->queue_length = 1000;
  EXPECT_EQ(checkQueue(facts).verdict, Verdict::kWarn);
  facts.link->qdisc = "fq_codel";
  EXPECT_EQ(checkQueue(facts).verdict, Verdict::kFail);
  facts.link->kind = "vcan";
  facts.link->qdisc = "noqueue";
  EXPECT_EQ(checkQueue(facts).verdict, Verdict::kPass);
}

TEST(CanLinkCheck, ErrorsAreJudgedByWhatTheySay) {
  auto facts = good();
  facts.link->rec = 3;
  EXPECT_EQ(checkErrors(facts).verdict, Verdict::kPass);
  facts.link->tec = 128;
  facts.link->state = CanState::kPassive;
  EXPECT_EQ(checkErrors(facts).verdict, Verdict::kWarn);
  facts.link->state = CanState::kBusOff;
  EXPECT_EQ(checkErrors(facts).verdict, Verdict::kFail);
  facts = good();
  facts.link->rx_lost = 5;
  EXPECT_EQ(checkErrors(facts).verdict, Verdict::kWarn);
}

TEST(CanLinkCheck, CoalescingMustNotHoldAFrameBack) {
  auto facts = good();
  facts.coalescing = Coalescing{.rx_delay_us = 0, .rx_frames = 8};
  EXPECT_EQ(checkCoalescing(facts).verdict, Verdict::kFail);
  facts.coalescing = Coalescing{.rx_delay_us = 1000, .rx_frames = 8};
  EXPECT_EQ(checkCoalescing(facts).verdict, Verdict::kWarn);
  facts.coalescing = Coalescing{.rx_delay_us = 250, .rx_frames = 8};
  EXPECT_EQ(checkCoalescing(facts).verdict, Verdict::kPass);
  facts.coalescing.reset();
  EXPECT_EQ(checkCoalescing(facts).verdict, Verdict::kPass);
}

TEST(CanLinkCheck, WhatFailsOrWarnsAlwaysSaysTheFix) {
  auto facts = good();
  facts.link = CanLink{};
  facts.link->is_can = true;
  facts.link->kind = "can";
  facts.link->restart_ms = 5;
  facts.link->qdisc = "fq_codel";
  facts.link->state = CanState::kBusOff;
  for (const auto& finding : checkCanLink(facts))
    EXPECT_EQ(finding.fix.empty(), finding.verdict == Verdict::kPass) << finding.what;
}

}  // namespace
}  // namespace rc10::doctor::link_check_test
