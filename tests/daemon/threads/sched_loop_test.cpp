#include "daemon/threads/sched_loop.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <ctime>
#include <thread>
#include <vector>

#include "app/timespec.hpp"
#include "bus/socket_pair.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/threads/rx_loop.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::sched_loop_test {
namespace {

using namespace std::chrono_literals;

// The scheduler reads its clock once in a tick, when its frames have left: that takes so long.
std::atomic<Duration> load{};
std::atomic<int> ticks_left{};
std::stop_source* ended = nullptr;

// Least time from the grid point of a tick to that.
TimeGrid grid{1ms};
Duration least_late = Duration::max();

MonotonicTime loadedClock() noexcept {
  least_late = std::min(least_late, (monotonicNow().time_since_epoch() - grid.offset) % grid.period);
  const Duration until = threadCpuTime() + load.load();
  while (threadCpuTime() < until) {
  }
  if (--ticks_left == 0) ended->request_stop();
  return monotonicNow();
}

// A thread that has its CPU for itself, however busy the computer is.
Duration allOfTheTime() noexcept { return monotonicNow().time_since_epoch(); }
// One that is late because others have it.
Duration noneOfTheTime() noexcept { return {}; }

// A signal whose handler keeps the thread past its next grid point, which it waits for.
void keep(int /*signal*/) {
  const timespec for_so_long = toTimespec(15ms);
  (void)::clock_nanosleep(CLOCK_MONOTONIC, 0, &for_so_long, nullptr);
}

MonotonicTime keptClock() noexcept {
  if (--ticks_left == 0) ended->request_stop();
  if (ticks_left != 2) return monotonicNow();
  sigevent event{};
  event.sigev_notify = SIGEV_THREAD_ID;
  event.sigev_signo = SIGALRM;
  event._sigev_un._tid = ::gettid();
  timer_t timer{};
  const itimerspec after_the_tick{.it_interval = {}, .it_value = toTimespec(5ms)};
  EXPECT_EQ(::timer_create(CLOCK_MONOTONIC, &event, &timer), 0);
  EXPECT_EQ(::timer_settime(timer, 0, &after_the_tick, nullptr), 0);
  return monotonicNow();
}

class SchedLoopTest : public ::testing::Test {
 protected:
  SchedLoopTest() {
    ended = &stop;
    grid = {1ms};
  }
  ~SchedLoopTest() override { ended = nullptr; }

  /// An e-stop as clients send it, and one look of the RX thread.
  void sendEstop(std::string_view client) {
    ASSERT_GE(::send(socket.far.get(), client.data(), client.size(), MSG_DONTWAIT), 0);
    const auto rx =
        RxLoop::create(nullptr, std::nullopt, RxLoop::Estops{EstopDatagrams{socket.near.get()}, exchange})
            .value();
    rx->look(monotonicNow());
  }

  /// Ticks with so much work each, and the orderly stop.
  void run(Duration work, int ticks, CanIntake* intake = nullptr) {
    load = work;
    ticks_left = ticks;
    const auto loop = SchedLoop::create(scheduler, settings, intake).value();
    loop->run(stop.get_token());
    long_sends = loop->timing().late.of(TickStep::kSend).ticks;
    late_wakes = loop->timing().late.of(TickStep::kWake).ticks;
    exchange.events.consume_all([&](const Event& event) { events.push_back(event); });
  }
  /// Stop of the whole robot.
  [[nodiscard]] std::vector<StopCause> stops() const {
    std::vector<StopCause> causes;
    for (const Event& event : events) {
      if (event.code == EventCode::kRobotState && event.value == static_cast<int>(RobotStatus::kEstop))
        causes.push_back(ExtraPair<RobotStatus, StopCause>::from(event.extra).second);
    }
    return causes;
  }

  std::unique_ptr<Robot> robot = Robot::build(twoWheelsAndYaw()).value();
  std::array<BusInbox, kMaxBuses> inboxes;
  LinkExchange exchange;
  Scheduler scheduler{*robot, inboxes, exchange, 1ms, nullptr, &loadedClock};
  std::stop_source stop;
  SocketPair socket;
  SchedLoop::Settings settings{.grid = {1ms}, .overload = 20ms, .cpu_time = allOfTheTime};
  std::vector<Event> events;
  std::uint64_t long_sends = 0;
  std::uint64_t late_wakes = 0;
};

TEST_F(SchedLoopTest, TicksThatUseMoreThanTheirPeriodStopTheRobot) {
  // Ten of them suffice, where the computer does not stand still between two.
  constexpr int kTicks = 120;
  run(2ms, kTicks);
  EXPECT_EQ(stops(), std::vector{StopCause::kOverload});
  EXPECT_GE(long_sends, kTicks) << "each is counted, by its longest step";
  EXPECT_LT(late_wakes, kTicks) << "the timer is not what delays the next one";
}

// The kernel throttles from 95 % on.
TEST_F(SchedLoopTest, TicksThatNearlyFillTheirPeriodStopTheRobotToo) {
  run(970us, 150);
  EXPECT_EQ(stops(), std::vector{StopCause::kOverload});
}

TEST_F(SchedLoopTest, AnOverloadIsJudgedByWhatTheKernelLeaves) {
  settings.realtime_percent = 50;
  run(600us, 150);
  EXPECT_EQ(stops(), std::vector{StopCause::kOverload});
}

TEST_F(SchedLoopTest, TicksThatFitDoNot) {
  settings.cpu_time = threadCpuTime;
  run(50us, 100);
  EXPECT_TRUE(stops().empty());
}

TEST_F(SchedLoopTest, TicksThatAreLateWithoutUsingTheCpuDoNotStopIt) {
  settings.cpu_time = noneOfTheTime;
  run(2ms, 50);
  EXPECT_TRUE(stops().empty());
}

TEST_F(SchedLoopTest, AnOverloadHasItsLimit) {
  settings.overload = 60s;
  run(2ms, 30);
  EXPECT_TRUE(stops().empty());
}

TEST_F(SchedLoopTest, AThreadThatWakesLateIsCountedAsThat) {
  struct sigaction before {};
  struct sigaction keeper {};
  keeper.sa_handler = &keep;
  ASSERT_EQ(::sigaction(SIGALRM, &keeper, &before), 0);
  Scheduler kept{*robot, inboxes, exchange, 10ms, nullptr, &keptClock};
  ticks_left = 4;
  const auto loop = SchedLoop::create(kept, {.grid = {10ms}, .overload = 100ms}, nullptr).value();
  loop->run(stop.get_token());
  ASSERT_EQ(::sigaction(SIGALRM, &before, nullptr), 0);
  const auto late = loop->timing().late.of(TickStep::kWake);
  EXPECT_GE(late.ticks, 1U);
  EXPECT_GE(late.time, 5ms);
}

// The grid is coarse: of some ticks one is in time on a busy computer too, and none is late by a phase.
class SchedLoopPhaseTest : public SchedLoopTest, public ::testing::WithParamInterface<Duration> {};

TEST_P(SchedLoopPhaseTest, TicksLieOnTheirGrid) {
  settings.grid = grid = {50ms, GetParam()};
  least_late = Duration::max();
  run(0us, 5);
  EXPECT_LT(least_late, 5ms);
}

INSTANTIATE_TEST_SUITE_P(All, SchedLoopPhaseTest, ::testing::Values(15ms, 37500us));

// `receive: tick`. Nobody steps the simulated drives: the frame waits in the bus's socket.
TEST_F(SchedLoopTest, ATickActsOnFramesThatCameBeforeIt) {
  const int drives = robot->simPorts()[0]->descriptor();
  const CanFrame feedback = frameOf("201#1000003C00001900");
  canfd_frame wire{};
  ASSERT_GT(::send(drives, &wire, encodeFrame(feedback, wire), MSG_DONTWAIT), 0);
  CanIntake intake{*robot, inboxes, monotonicNow()};
  run(0us, 1, &intake);
  const MotorFeedback& seen = robot->motors()[0].motor->feedback();
  EXPECT_EQ(seen.samples, 1U);
  EXPECT_LE(seen.received, exchange.snapshot.read().sent);
}

TEST_F(SchedLoopTest, AnEstopByDatagramActsInTheNextTickHoweverFullTheRingsAre) {
  while (exchange.orders.push(Order{})) {
  }
  sendEstop("pult");
  run(0us, 2);
  EXPECT_EQ(stops(), std::vector{StopCause::kRequest});
  const auto stopped = std::find_if(events.begin(), events.end(), [](const Event& event) {
    return event.code == EventCode::kRobotState;  // before it a busy computer may have missed ticks
  });
  ASSERT_NE(stopped, events.end());
  EXPECT_EQ(stopped->client.view(), "pult");
}

}  // namespace
}  // namespace rc10::test::sched_loop_test
