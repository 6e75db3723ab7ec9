// A scan of one bus: it hears, asks at its pace, and gives way to everything else.

#include <algorithm>
#include <optional>
#include <vector>

#include <gmock/gmock.h>

#include "bus/frame_tap.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"
#include "survey/harmless_queries.hpp"

namespace rc10::test::supervisor_scan_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kArm = 3;
constexpr std::size_t kScanned = 0;
constexpr std::uint64_t kScan = 77;
constexpr int kQuestions = 20;

/// Beside the wheels a bus with one motor more.
RobotConfig twoBuses() {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[kLeft].guard = {.temperature_derate_c = 70.0F, .temperature_trip_c = 90.0F};
  BusConfig second;
  second.name = "arm";
  second.type = BusType::kSimulated;
  second.motors = {makeMotor("arm", kM3508, 4)};
  config.buses.push_back(std::move(second));
  return config;
}

/// Questions that are sent, by tick.
class Questions final : public FrameTap {
 public:
  void onReceived(const CanFrame&) noexcept override {}
  void onSent(const CanFrame& frame, bool accepted) noexcept override {
    if (frame.id.extended && accepted) ++sent;
  }
  int sent = 0;
};

class ScanTest : public ::testing::Test {
 protected:
  ScanTest() {
    robot.robot().buses()[kScanned].bus->setTap(questions);
    robot.run(5);
  }

  Order scanOrder(bool listen_only = false) {
    Order order;
    order.id = kScan;
    order.operation = Operation::kScan;
    order.motors = MotorSet{0b0111};
    order.scan = {.bus = kScanned, .listen = 100ms, .between = 2ms, .listen_only = listen_only};
    return order;
  }
  void begin(const Order& order) {
    ASSERT_TRUE(robot.exchange().orders.push(order));
    robot.tick();
  }
  /// As the link thread does.
  void handOverQuestions() {
    auto& scan = robot.exchange().scan;
    const auto all = survey::harmlessQueries();
    scan.question_count = kQuestions;
    std::copy_n(all.begin(), kQuestions, scan.questions.begin());
    scan.ready.store(kScan, std::memory_order_release);
  }
  [[nodiscard]] bool listened() {
    return robot.exchange().scan.listened.load(std::memory_order_acquire) == kScan;
  }
  std::optional<OrderResult> result(std::uint64_t id = kScan) {
    OrderResult out;
    while (robot.exchange().results.pop(out)) {
      if (out.id == id) return out;
    }
    return std::nullopt;
  }
  OrderResult ended(std::uint64_t id = kScan) {
    for (int i = 0; i < 5000; ++i) {
      if (const auto out = result(id)) return *out;
      robot.tick();
    }
    ADD_FAILURE() << "the scan did not end";
    return {};
  }
  OrderResult refused(const Order& order) {
    begin(order);
    const auto out = ended();
    EXPECT_TRUE(out.refused);
    EXPECT_EQ(questions.sent, 0);
    return out;
  }
  void enable(std::size_t motor) { robot.orderFor(MotorSet{}.set(motor), Operation::kEnable); }
  void asking() {
    begin(scanOrder());
    robot.run(101);
    ASSERT_TRUE(listened());
    handOverQuestions();
  }

  VirtualRobot robot{twoBuses()};
  Questions questions;
};

TEST_F(ScanTest, HearsTheFramesOfItsBusAlone) {
  begin(scanOrder());
  robot.run(50);
  std::vector<CanFrame> heard;
  robot.exchange().scan.heard.consume_all([&](const CanFrame& frame) { heard.push_back(frame); });
  EXPECT_GT(heard.size(), 120U);
  for (const auto& frame : heard) EXPECT_NE(frame.id, (CanId{0x204, false})) << "of the other bus";
}

TEST_F(ScanTest, NothingIsHeardForItWithoutAScan) {
  robot.run(50);
  EXPECT_EQ(robot.exchange().scan.heard.read_available(), 0U);
}

TEST_F(ScanTest, ListensBeforeItAsks) {
  begin(scanOrder());
  handOverQuestions();
  robot.run(98);
  EXPECT_FALSE(listened());
  EXPECT_EQ(questions.sent, 0);
  robot.run(4);
  EXPECT_TRUE(listened());
  EXPECT_GT(questions.sent, 0);
}

TEST_F(ScanTest, AsksOneQuestionInATickAtMostAndKeepsItsPace) {
  asking();
  for (int tick = 1; tick <= 2 * kQuestions; ++tick) {
    const int before = questions.sent;
    robot.tick();
    EXPECT_LE(questions.sent - before, 1);
    EXPECT_LE(questions.sent, tick / 2 + 1) << "every 2 ms";
  }
  EXPECT_EQ(questions.sent, kQuestions);
  const auto end = ended();
  EXPECT_FALSE(end.refused);
  EXPECT_EQ(end.scan, Refusal::kNone);
  EXPECT_EQ(end.asked, static_cast<std::uint32_t>(kQuestions));
  robot.run(100);
  EXPECT_EQ(questions.sent, kQuestions);
}

TEST_F(ScanTest, HearsTheAnswerToTheLastQuestion) {
  asking();
  while (questions.sent < kQuestions) robot.tick();
  for (int i = 0; i < 195; ++i) {
    robot.tick();
    ASSERT_FALSE(result()) << "after " << i << " ms";
  }
  ended();
}

TEST_F(ScanTest, ListeningOnlyItAsksNothing) {
  begin(scanOrder(true));
  handOverQuestions();
  const auto end = ended();
  EXPECT_EQ(end.scan, Refusal::kNone);
  EXPECT_EQ(end.asked, 0U);
  EXPECT_EQ(questions.sent, 0);
}

TEST_F(ScanTest, IsRefusedWhileAMotorOfItsBusIsActive) {
  enable(kLeft);
  const auto result = refused(scanOrder());
  EXPECT_EQ(result.motors[kLeft], Refusal::kActive);
  EXPECT_EQ(result.motors[1], Refusal::kNone);
}

TEST_F(ScanTest, IsRefusedWhileAMotorOfItsBusIsEnabling) {
  ASSERT_TRUE(robot.exchange().orders.push(
      {.id = 1, .operation = Operation::kEnable, .motors = MotorSet{}.set(kLeft)}));
  const auto out = refused(scanOrder());
  EXPECT_EQ(out.motors[kLeft], Refusal::kActive);
}

TEST_F(ScanTest, IsRefusedWhileAMotorOfItsBusTurns) {
  robot.simBus().turnByHand(kLeft, {.by_deg = 3600.0, .speed_rpm = 120.0, .torque_nm = 20.0});
  robot.run(100);
  EXPECT_EQ(refused(scanOrder()).motors[kLeft], Refusal::kMoving);
}

TEST_F(ScanTest, IsRefusedWhileAMotorOfItsBusIsInFault) {
  enable(kLeft);
  robot.simBus().setTemperature(kLeft, 95.0);
  robot.run(2000);
  ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kFault);
  EXPECT_EQ(refused(scanOrder()).motors[kLeft], Refusal::kFaulted);
}

TEST_F(ScanTest, MotorsOfOtherBusesMayMove) {
  enable(kArm);
  asking();
  for (int i = 0; i < 60; ++i) {
    robot.command(kArm, {.mode = ControlMode::kVelocity, .value = 60.0});
    robot.tick();
  }
  EXPECT_EQ(questions.sent, kQuestions);
  EXPECT_EQ(ended().scan, Refusal::kNone);
}

TEST_F(ScanTest, OfflineMotorsAreNoReasonAgainstIt) {
  robot.simBus().silence(kLeft, true);
  robot.run(6000);
  ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kOffline);
  asking();
  robot.run(50);
  EXPECT_EQ(questions.sent, kQuestions);
}

TEST_F(ScanTest, AMotorThatIsEnabledMeanwhileEndsItBeforeAnotherQuestion) {
  asking();
  robot.run(10);
  const int before = questions.sent;
  ASSERT_GT(before, 0);
  ASSERT_TRUE(robot.exchange().orders.push(
      {.id = 1, .operation = Operation::kEnable, .motors = MotorSet{}.set(kLeft)}));
  robot.tick();
  const auto end = result();
  ASSERT_TRUE(end) << "in the very tick";
  EXPECT_EQ(end->id, kScan);
  EXPECT_FALSE(end->refused);
  EXPECT_EQ(end->motors[kLeft], Refusal::kActive);
  robot.run(100);
  EXPECT_EQ(questions.sent, before);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
}

TEST_F(ScanTest, AMotorThatIsEnabledWhileItListensEndsIt) {
  begin(scanOrder());
  robot.run(10);
  ASSERT_TRUE(robot.exchange().orders.push(
      {.id = 1, .operation = Operation::kEnable, .motors = MotorSet{}.set(kLeft)}));
  robot.tick();
  const auto end = result();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->motors[kLeft], Refusal::kActive);
  handOverQuestions();
  robot.run(200);
  EXPECT_EQ(questions.sent, 0);
}

TEST_F(ScanTest, AStopOfTheProcessEndsIt) {
  asking();
  robot.run(4);
  const int before = questions.sent;
  robot.scheduler().beginStop();
  robot.tick();
  const auto end = result();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->scan, Refusal::kStopping);
  robot.run(20);
  EXPECT_EQ(questions.sent, before);
}

TEST_F(ScanTest, ABusThatCarriesNoFramesEndsIt) {
  asking();
  robot.run(4);
  robot.inboxes()[kScanned].link.store(CanLinkState::kDown);
  robot.run(2);
  const auto end = result();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->scan, Refusal::kBusHeld);
}

TEST_F(ScanTest, OneIsMadeAtATime) {
  begin(scanOrder());
  auto second = scanOrder();
  second.id = kScan + 1;
  begin(second);
  const auto out = result(kScan + 1);
  ASSERT_TRUE(out);
  EXPECT_TRUE(out->refused);
  EXPECT_EQ(out->scan, Refusal::kScanning);
}

TEST_F(ScanTest, EndsWhenNobodyJudgesWhatWasHeard) {
  begin(scanOrder());
  EXPECT_EQ(ended().scan, Refusal::kTooBusy);
  EXPECT_EQ(questions.sent, 0);
}

TEST_F(ScanTest, OneForWhichNobodyWaitsEndsBeforeAnotherQuestionAndLeavesTheBusToTheNext) {
  asking();
  robot.run(4);
  const int before = questions.sent;
  ASSERT_GT(before, 0);
  robot.exchange().scan.given_up.store(kScan);
  robot.tick();
  const auto end = result();
  ASSERT_TRUE(end) << "in the very tick";
  EXPECT_EQ(end->scan, Refusal::kClientGone);
  robot.run(20);
  EXPECT_EQ(questions.sent, before);
  auto next = scanOrder(true);
  next.id = kScan + 1;
  begin(next);
  EXPECT_EQ(ended(next.id).scan, Refusal::kNone);
}

TEST_F(ScanTest, OneThatIsGivenUpBeforeItsFirstTickAsksNothing) {
  handOverQuestions();
  robot.exchange().scan.given_up.store(kScan);
  begin(scanOrder());
  const auto end = result();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->scan, Refusal::kClientGone);
  EXPECT_EQ(questions.sent, 0);
}

TEST_F(ScanTest, QuestionsOfAnEarlierScanAreNotItsOwn) {
  handOverQuestions();
  auto order = scanOrder();
  order.id = kScan + 1;
  begin(order);
  EXPECT_EQ(ended(kScan + 1).scan, Refusal::kTooBusy);
  EXPECT_EQ(questions.sent, 0);
}

TEST_F(ScanTest, FramesThatFindNoRoomAreCounted) {
  auto order = scanOrder(true);
  order.scan.listen = 1s;
  begin(order);
  ended();
  const auto& scan = robot.exchange().scan;
  EXPECT_EQ(scan.heard.read_available(), BusScanExchange::kFrames);
  EXPECT_GT(scan.dropped.load(), 1000U);
}

TEST_F(ScanTest, ItsTicksAllocateNothing) {
  ASSERT_TRUE(robot.exchange().orders.push(scanOrder()));
  std::uint64_t allocated = 0;
  for (int i = 0; i < 500; ++i) {
    if (i == 150) handOverQuestions();
    const AllocGuard guard;
    robot.tick();
    allocated += guard.allocations();
  }
  EXPECT_EQ(questions.sent, kQuestions);
  EXPECT_EQ(allocated, 0U);
}

}  // namespace
}  // namespace rc10::test::supervisor_scan_test
