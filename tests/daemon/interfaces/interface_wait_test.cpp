#include "daemon/interfaces/interface_wait.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "app/unique_fd.hpp"

namespace rc10::test::interface_wait_test {
namespace {

using namespace std::chrono_literals;

class InterfaceWaitTest : public ::testing::Test {
 protected:
  InterfaceWaitTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    read_ = UniqueFd{ends[0]};
    write_ = UniqueFd{ends[1]};
    for (const auto* name : {"can0", "can1"}) {
      BusConfig bus;
      bus.interface = name;
      config_.buses.push_back(bus);
    }
    BusConfig simulated;
    simulated.type = BusType::kSimulated;
    config_.buses.push_back(simulated);
  }
  InterfaceWait wait() {
    return InterfaceWait{config_, [this](const std::string& name) {
                           if (++looks_ == 4) there_.insert("can1");
                           return there_.contains(name);
                         }};
  }

  RobotConfig config_;
  std::set<std::string> there_{"can0"};
  int looks_ = 0;
  UniqueFd read_;
  UniqueFd write_;
};

TEST_F(InterfaceWaitTest, EndsAsSoonAsEveryInterfaceIsThere) {
  const auto waiting = wait();
  EXPECT_EQ(waiting.missing(), "can1");
  EXPECT_EQ(waiting.run(read_.get(), 8s), InterfaceWait::End::kThere);
  EXPECT_EQ(waiting.missing(), "");
}

TEST_F(InterfaceWaitTest, EndsAfterItsTime) {
  looks_ = 100;
  EXPECT_EQ(wait().run(read_.get(), 1ms), InterfaceWait::End::kTooLong);
}

TEST_F(InterfaceWaitTest, EndsWhenASignalComes) {
  looks_ = 100;
  ASSERT_EQ(::write(write_.get(), "x", 1), 1);
  EXPECT_EQ(wait().run(read_.get(), 8s), InterfaceWait::End::kSignal);
}

TEST_F(InterfaceWaitTest, LooksAtTheInterfacesOfThisComputer) {
  config_.buses.resize(1);
  config_.buses[0].interface = "lo";
  EXPECT_EQ(InterfaceWait{config_}.missing(), "");
  config_.buses[0].interface = "rc10_none";
  EXPECT_EQ(InterfaceWait{config_}.missing(), "rc10_none");
}

// systemd gives up after so many starts in so long a time.
TEST(ServiceUnit, GoesOnStartingForAsLongAsAnInterfaceIsMissing) {
  std::ostringstream read;
  read << std::ifstream{std::string{RC10_SOURCE_DIR} + "/systemd/rc10d.service"}.rdbuf();
  const auto unit = read.str();
  const auto number = [&unit](const std::string& key) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(unit, found, std::regex{"\n" + key + "=([0-9]+)\n"})) << key;
    return std::stoi(found[1]);
  };
  const auto each_s = std::chrono::duration_cast<std::chrono::seconds>(InterfaceWait::kLongest).count() +
                      number("RestartSec");
  EXPECT_GT(each_s * number("StartLimitBurst"), number("StartLimitIntervalSec"));
  EXPECT_LT(InterfaceWait::kLongest, std::chrono::seconds{number("TimeoutStartSec")});
}

}  // namespace
}  // namespace rc10::test::interface_wait_test
