#include "rc10/module.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_rc10d.hpp"
#include "rc10/robot.hpp"
#include "rc10/signals_t.hpp"
#include "rc10/subscriber.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::module_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsNan;

/// A program and the module `base` of its robot, on one memq link.
class ModuleTest : public testing::Test {
 protected:
  static constexpr const char* kChannel = "hero.v1.base";

  RobotOptions options() {
    RobotOptions options;
    options.client = "tester";
    options.priority = 7;
    options.on_problem = [this](const std::string& text) {
      const std::lock_guard lock(mutex_);
      problems_.push_back(text);
    };
    return options;
  }

  /// A state of the module.
  void publish(const Signals& outputs, const std::string& owner = "") {
    signals_t message{};
    message.client = owner;
    for (const auto& [name, value] : outputs) {
      message.names.push_back(name);
      message.values.push_back(value);
    }
    message.count = static_cast<std::int32_t>(outputs.size());
    ASSERT_TRUE(link_.publish(std::string(kChannel) + ".state", message));
  }
  /// Has it said, and waits until the robot knows: handlers are called in the order of their subscriptions.
  void see(const Signals& outputs, const std::string& owner = "") {
    std::promise<void> seen;
    auto future = seen.get_future();
    bool first = true;
    const auto last = link_.subscribe(std::string(kChannel) + ".state", [&](auto) {
      if (std::exchange(first, false)) seen.set_value();
    });
    publish(outputs, owner);
    ASSERT_EQ(future.wait_for(kPatience), std::future_status::ready);
  }

  /// The messages to the module, once there are as many.
  std::vector<signals_t> inputs(std::size_t count) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, kPatience, [&] { return inputs_.size() >= count; }));
    return inputs_;
  }

  std::vector<std::string> problems() {
    const std::lock_guard lock(mutex_);
    return problems_;
  }

  LcmLink link_{"memq://"};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<signals_t> inputs_;
  std::vector<std::string> problems_;
  Subscriber<signals_t> given_{link_, kChannel, [this](const signals_t& message) {
                                 {
                                   const std::lock_guard lock(mutex_);
                                   inputs_.push_back(message);
                                 }
                                 changed_.notify_all();
                               }};
  Robot robot_{"hero", link_, options()};
  Module base_ = robot_.module("base");
};

TEST_F(ModuleTest, InputsGoOutOnceWithWhoHowLongAndGrowingNumbers) {
  ASSERT_TRUE(base_.send({{"vx_m_s", 0.5}, {"wz_deg_s", 30}}, {.validity = 100ms}));
  ASSERT_TRUE(base_.send({{"vx_m_s", 0.0}}, {.priority = 9}));
  const auto seen = inputs(2);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].client, "tester");
  EXPECT_EQ(seen[0].priority, 7);
  EXPECT_EQ(seen[0].validity_ms, 100);
  ASSERT_EQ(seen[0].count, 2);
  EXPECT_EQ(seen[0].names[0], "vx_m_s");
  EXPECT_EQ(seen[0].values[0], 0.5);
  EXPECT_EQ(seen[0].names[1], "wz_deg_s");
  EXPECT_EQ(seen[0].values[1], 30.0);
  EXPECT_EQ(seen[1].priority, 9);
  EXPECT_EQ(seen[1].validity_ms, 0);
  EXPECT_EQ(seen[1].session, seen[0].session);
  EXPECT_NE(seen[0].session, 0);
  EXPECT_GT(seen[1].seq, seen[0].seq);
}

TEST_F(ModuleTest, LeavingEndsTheInputsAtOnce) {
  ASSERT_TRUE(base_.send({{"vx_m_s", 0.5}}, {.validity = 1000ms, .priority = 9}));
  ASSERT_TRUE(robot_.close());
  const auto seen = inputs(2);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[1].validity_ms, 1);
  EXPECT_EQ(seen[1].names, seen[0].names);
  EXPECT_EQ(seen[1].values, seen[0].values) << "no other movement in its last tick";
  EXPECT_EQ(seen[1].priority, 9);
  EXPECT_EQ(seen[1].session, seen[0].session);
  EXPECT_GT(seen[1].seq, seen[0].seq);
}

TEST_F(ModuleTest, TheStateHasItsOutputsItsOwnerAndItsAge) {
  EXPECT_FALSE(base_.state());
  EXPECT_THAT(base_.state()["x_m"], IsNan());
  EXPECT_GT(base_.state().age(), 1s);
  const auto before = std::chrono::steady_clock::now();
  see({{"x_m", 1.5}, {"vx_m_s", kUnknown}}, "planner");
  const auto state = base_.state();
  ASSERT_TRUE(state);
  EXPECT_EQ(state["x_m"], 1.5);
  EXPECT_THAT(state["vx_m_s"], IsNan());
  EXPECT_EQ(state.owner, "planner");
  EXPECT_GE(state.received, before);
  EXPECT_GE(state.age(), 0ns);
}

TEST_F(ModuleTest, AnOutputOfAnotherNameIsTold) {
  EXPECT_THAT(base_.output("x"), IsNan());
  EXPECT_TRUE(problems().empty()) << "nobody knows the names yet";
  see({{"x_m", 1.5}, {"y_m", 2.5}});
  EXPECT_EQ(base_.output("y_m"), 2.5);
  EXPECT_TRUE(problems().empty());
  EXPECT_THAT(base_.output("x"), IsNan());
  ASSERT_EQ(problems().size(), 1U);
  EXPECT_EQ(problems()[0], "base has no output 'x'; there are x_m, y_m; did you mean x_m?");
  EXPECT_THAT(base_.output("x_mm"), IsNan());
  ASSERT_EQ(problems().size(), 2U);
  EXPECT_EQ(problems()[1], "base has no output 'x_mm'; there are x_m, y_m; did you mean x_m?");
}

TEST_F(ModuleTest, WhatNoModuleTakesIsNotSent) {
  EXPECT_EQ(base_.send({}).error().message, "base takes 1 to 32 inputs, not 0");
  EXPECT_THAT(base_.send({{"vx_m_s", kUnknown}}).error().message, HasSubstr("vx_m_s is not finite"));
  EXPECT_THAT(base_.send({{"vx_m_s", 1.0}}, {.validity = 1001ms}).error().message, HasSubstr("1 to 1000 ms"));
  EXPECT_THAT(base_.send({{"vx_m_s", 1.0}}, {.validity = -1ms}).error().message, HasSubstr("1 to 1000 ms"));
  EXPECT_THAT(base_.send({{std::string(32, 'x'), 1.0}}).error().message, HasSubstr("no input's name"));
  Signals many;
  for (int i = 0; i < 33; ++i) many["input_" + std::to_string(i)] = 1.0;
  EXPECT_EQ(base_.send(many).error().message, "base takes 1 to 32 inputs, not 33");
  ASSERT_TRUE(base_.send({{"vx_m_s", 1.0}}));
  EXPECT_EQ(inputs(1).size(), 1U);
  EXPECT_GE(problems().size(), 5U) << "each is told, also to a program that does not look";
}

TEST_F(ModuleTest, InputsForAModuleThatIsNotThereAreToldOnce) {
  FakeRc10d rc10d{link_, "hero"};
  const auto missing = robot_.module("bsae");
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (problems().empty() && std::chrono::steady_clock::now() < until) {
    rc10d.publishState();
    see({{"x_m", 1.5}});
    ASSERT_TRUE(base_.send({{"vx_m_s", 1.0}}));
    ASSERT_TRUE(missing.send({{"vx_m_s", 1.0}}));
  }
  ASSERT_TRUE(missing.send({{"vx_m_s", 1.0}}));
  EXPECT_THAT(problems(), testing::ElementsAre("robot 'hero' is heard, and nothing of module 'bsae' to which "
                                               "inputs are sent: `rc10ctl modules` shows which there are"));
}

TEST_F(ModuleTest, AMisspeltNameIsToldWithThoseThatAreHeard) {
  std::promise<void> stop;
  auto stopped = stop.get_future().share();
  std::thread publishing([&] {
    while (stopped.wait_for(2ms) == std::future_status::timeout) publish({{"x_m", 1.5}});
  });
  const auto missing = robot_.module("bsae").waitForState(50ms);
  stop.set_value();
  publishing.join();
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("Heard here: module 'base'; did you mean base?"));
}

TEST_F(ModuleTest, WaitsForWhatTheModuleSays) {
  const auto missing = base_.waitForState(1ms);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("nothing of module 'base' within 1 ms"));
  EXPECT_THAT(missing.error().message, HasSubstr("rc10ctl modules"));
  std::promise<void> stop;
  auto stopped = stop.get_future().share();
  std::thread publishing([&] {
    while (stopped.wait_for(2ms) == std::future_status::timeout) publish({{"x_m", 1.5}});
  });
  EXPECT_TRUE(base_.waitForState(kPatience));
  stop.set_value();
  publishing.join();
  EXPECT_EQ(base_.state()["x_m"], 1.5);
}

TEST_F(ModuleTest, WaitingInACallbackIsAnErrorAndNoDeadlock) {
  std::promise<std::string> told;
  const auto subscription = link_.subscribe("go", [&](auto) {
    const auto waited = base_.waitForState();
    told.set_value(waited ? "" : waited.error().message);
  });
  ASSERT_TRUE(link_.publish("go", std::span<const std::byte>{}));
  EXPECT_EQ(told.get_future().get(), "base.waitForState() in a callback would wait for itself");
}

TEST_F(ModuleTest, AClosedRobotGivesNothing) {
  ASSERT_TRUE(robot_.close());
  EXPECT_EQ(base_.send({{"vx_m_s", 1.0}}).error().message, "the robot is closed");
}

TEST(ModuleWithoutLcm, SaysHowToGetIt) {
  const LcmLink none{"nonsense://"};
  RobotOptions options;
  options.on_problem = [](const std::string&) {};
  const Robot robot("hero", none, options);
  const auto base = robot.module("base");
  EXPECT_THAT(base.send({{"vx_m_s", 1.0}}).error().message, HasSubstr("LCM could not start"));
  EXPECT_THAT(base.waitForState().error().message, HasSubstr("LCM could not start"));
  EXPECT_FALSE(base.state());
}

}  // namespace
}  // namespace test::module_test
}  // namespace robot_client
}  // namespace rc10
