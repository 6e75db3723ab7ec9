#include "doctor/irq_check.hpp"

#include <gmock/gmock.h>

#include "host_root.hpp"

namespace rc10::doctor {
namespace {

using ::testing::HasSubstr;

// As /proc/PID/stat: the 40th field is the real-time priority, the 41st the policy.
void thread(const HostRoot& root, int pid, const std::string& name, int priority, int policy) {
  std::string stat = std::to_string(pid) + " (" + name + ") S";
  for (int field = 4; field < 40; ++field) stat += " 0";
  root.write("/proc/" + std::to_string(pid) + "/stat",
             stat + " " + std::to_string(priority) + " " + std::to_string(policy) + " 0 0");
}

class SpiHat : public ::testing::Test {
 protected:
  void SetUp() override {
    root.link("/sys/class/net/can0/device", "../../../spi0.0");
    thread(root, 12, "spi0", 50, 1);
    thread(root, 13, "spi1", 50, 1);
    thread(root, 57, "irq/57-spi0.0", 50, 1);
    thread(root, 58, "irq/58-spi0.1", 50, 1);
    thread(root, 900, "bash) (odd", 0, 0);
    root.write("/proc/meminfo", "MemTotal: 1");
  }

  [[nodiscard]] Finding finding() const {
    const auto files = root.files();
    return checkInterruptThreads("can0", threadsOf("can0", files, readProcesses(files)), 65);
  }

  HostRoot root;
};

TEST_F(SpiHat, ItsInterruptAndItsControllerBelongAboveTheReceiveThread) {
  const auto low = finding();
  EXPECT_EQ(low.verdict, Verdict::kWarn);
  EXPECT_THAT(low.why, HasSubstr("spi0 50, irq/57-spi0.0 50"));
  EXPECT_THAT(low.fix, HasSubstr("chrt -f -p 70 12; sudo chrt -f -p 70 57"));
  EXPECT_THAT(low.fix, HasSubstr("after each"));
}

TEST_F(SpiHat, RaisedThreadsPass) {
  thread(root, 12, "spi0", 70, 1);
  thread(root, 57, "irq/57-spi0.0", 70, 1);
  EXPECT_EQ(finding().verdict, Verdict::kPass);
}

TEST_F(SpiHat, AThreadWithoutRealTimePriorityIsTooLow) {
  thread(root, 12, "spi0", 0, 0);
  EXPECT_THAT(finding().why, HasSubstr("spi0 not real-time"));
}

TEST(IrqCheck, AVirtualInterfaceHasNoInterrupt) {
  HostRoot root;
  thread(root, 57, "irq/57-spi0.0", 50, 1);
  const auto files = root.files();
  EXPECT_TRUE(threadsOf("vcan0", files, readProcesses(files)).empty());
  EXPECT_EQ(checkInterruptThreads("vcan0", {}, 65).verdict, Verdict::kPass);
}

}  // namespace
}  // namespace rc10::doctor
