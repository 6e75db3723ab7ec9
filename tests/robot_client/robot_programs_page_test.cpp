// The fragments of docs/robot-programs.md, compiled; tests/docs compares them with the page.
#include <iostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rc10/counter_t.hpp"
#include "rc10/named_value_t.hpp"
#include "rc10/publisher.hpp"
#include "rc10/robot.hpp"
#include "rc10/rtos_queue.hpp"
#include "rc10/rtos_task.hpp"
#include "rc10/service_client.hpp"
#include "rc10/service_server.hpp"
#include "rc10/subscriber.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::robot_programs_page_test {
namespace {

using namespace rc10::literals;
using namespace std::chrono_literals;

// Types of a user's own.
using pose_t = counter_t;
using grab_t = named_value_t;
using grabbed_t = counter_t;

rc10::RtosQueue<int> shots(8);

void fire(int /*shot*/) {}
void aim(const pose_t& /*pose*/) {}
int failed(const std::string& /*message*/) { return 1; }

[[maybe_unused]] void moves(rc10::Robot& robot) {
  auto lift = robot.motor("lift").moveTo(720_deg, 2_deg, 5s);  // std::future<rc10::MoveResult>
  auto arm = robot.motor("arm").moveToAngle(90_deg);           // both move now
  if (const auto result = lift.get(); !result) std::cerr << result.reason << '\n';
}

[[maybe_unused]] void requests(rc10::Robot& robot) {
  if (const auto done = robot.enable({"lift", "arm"}); !done) {
    for (const auto& [motor, reason] : done.error().motors) std::cerr << motor << ": " << reason << '\n';
  }
  const auto tuned = robot.motor("lift").setGains({{"velocity.kp", 0.4}, {"angle.kp", 5.0}});
  std::cout << (tuned ? tuned->message : tuned.error().message) << '\n';  // before and after, or why not
  if (const auto now = robot.motor("lift").gains())
    std::cout << now->message;  // the lines for the robot's file
}

class Feeder : public rc10::RtosTask {
 public:
  Feeder() : RtosTask({.name = "feeder", .policy = rc10::SchedPolicy::kFifo, .priority = 30, .cpu = 2}) {}
  ~Feeder() override { stop(); }

 protected:
  void loop() override {
    if (auto shot = shots.tryReceive()) fire(*shot);
  }
};

int tasks() {
  Feeder feeder;
  if (const auto started = feeder.start(5ms); !started) return failed(started.error().message);
  if (!feeder.problem().empty())
    std::cerr << feeder.problem() << '\n';  // not real-time, and how to change that
  return 0;
}

std::string messages(rc10::Robot& robot, rc10::LcmLink& link, const pose_t& pose, const grab_t& request) {
  rc10::Publisher<pose_t> poses(robot.link(), "vision.pose");
  poses.publish(pose);

  rc10::Subscriber<pose_t> vision(robot.link(), "vision.pose",
                                  [](const pose_t& each) { aim(each); });  // or without a callback:
  if (const auto seen = vision.latest(); seen && seen->age() < 100ms) aim(seen->message);

  rc10::ServiceServer<grab_t, grabbed_t> server(
      link, "gripper.grab",
      [](const grab_t&) -> rc10::Result<grabbed_t> { return rc10::fail("nothing there"); });
  rc10::ServiceClient<grab_t, grabbed_t> grab(link, "gripper.grab");
  const auto answer = grab.call(request, {.timeout = 500ms});  // answer.error().message
  return answer ? "" : answer.error().message;
}

TEST(RobotProgramsPage, ATaskStartsWithOrWithoutARightToItsPriority) { EXPECT_EQ(tasks(), 0); }

TEST(RobotProgramsPage, MessagesAndCallsGoBetweenPrograms) {
  rc10::LcmLink link("memq://");
  rc10::Robot robot("hero", link);
  EXPECT_THAT(messages(robot, link, {}, {}), testing::HasSubstr("nothing there"));
}

}  // namespace
}  // namespace test::robot_programs_page_test
}  // namespace robot_client
}  // namespace rc10
