#include "doctor/interrupt_threads.hpp"

#include <gmock/gmock.h>

#include "doctor/irq_check.hpp"
#include "host_root.hpp"

namespace rc10::doctor::interrupt_threads_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// As /proc/PID/stat: the 9th field has the kernel's flags, the 40th the real-time priority, the 41st the
// policy.
void process(const HostRoot& root, int pid, const std::string& name, unsigned flags, int priority,
             int policy) {
  std::string stat = std::to_string(pid) + " (" + name + ") S";
  for (int field = 4; field < 9; ++field) stat += " 0";
  stat += " " + std::to_string(flags);
  for (int field = 10; field < 40; ++field) stat += " 0";
  root.write("/proc/" + std::to_string(pid) + "/stat",
             stat + " " + std::to_string(priority) + " " + std::to_string(policy) + " 0 0");
}

void thread(const HostRoot& root, int pid, const std::string& name, int priority, int policy) {
  process(root, pid, name, 0x208040, priority, policy);
}

std::vector<std::string> names(const std::vector<Process>& threads) {
  std::vector<std::string> names;
  for (const auto& thread : threads) names.push_back(thread.name);
  return names;
}

class SpiHat : public ::testing::Test {
 protected:
  void SetUp() override {
    root.link("/sys/class/net/can0/device", "../../../spi0.0");
    root.link("/sys/class/net/can1/device", "../../../spi0.1");
    root.write("/sys/class/net/can0/type", "280");
    root.write("/sys/class/net/can1/type", "280");
    root.write("/sys/class/net/eth0/type", "1");
    root.write("/sys/class/net/can0/flags", "0x40081");
    root.write("/sys/class/net/can1/flags", "0x40080");
    thread(root, 12, "spi0", 50, 1);
    thread(root, 13, "spi1", 50, 1);
    thread(root, 57, "irq/57-spi0.0", 50, 1);
    thread(root, 58, "irq/58-spi0.1", 50, 1);
    process(root, 900, "bash) (odd", 0x400000, 0, 0);
    root.write("/proc/meminfo", "MemTotal: 1");
  }

  [[nodiscard]] std::vector<Process> threads(const std::string& interface) const {
    return threadsOf(interface, files, readProcesses(files));
  }
  [[nodiscard]] Finding finding() const {
    return checkInterruptThreads("can0", threads("can0"), {.priority = 65, .is_rx = true});
  }
  [[nodiscard]] std::vector<std::string> changes(const std::vector<std::string>& interfaces) const {
    std::vector<std::string> texts;
    for (const auto& [interface, thread] : priorityChanges(interfaces, 70, files, readProcesses(files))) {
      texts.push_back(interface + " " + thread.name + " " + priorityText(thread));
    }
    return texts;
  }

  HostRoot root;
  HostFiles files = root.files();
};

TEST_F(SpiHat, ItsInterruptAndItsControllerBelongAboveTheReceiveThread) {
  const auto low = finding();
  EXPECT_EQ(low.verdict, Verdict::kWarn);
  EXPECT_THAT(low.why, HasSubstr("spi0 50, irq/57-spi0.0 50"));
  EXPECT_THAT(low.fix, HasSubstr("sudo systemctl enable --now rc10-irq.service"));
  EXPECT_THAT(low.fix, HasSubstr("sudo rc10-irq"));
}

TEST_F(SpiHat, RaisedThreadsPass) {
  thread(root, 12, "spi0", 70, 1);
  thread(root, 57, "irq/57-spi0.0", 70, 1);
  EXPECT_EQ(finding().verdict, Verdict::kPass);
}

TEST_F(SpiHat, AboveAReceiveThreadWithAnotherPriorityTheyNeedAnotherToo) {
  thread(root, 57, "irq/57-spi0.0", 70, 1);
  EXPECT_THAT(checkInterruptThreads("can0", threads("can0"), {.priority = 75, .is_rx = true}).fix,
              HasSubstr("rc10-irq --watch --priority 76"));
}

TEST_F(SpiHat, WhereTheTickReadsCanTheyBelongAboveTheScheduler) {
  thread(root, 12, "spi0", 62, 1);
  thread(root, 57, "irq/57-spi0.0", 62, 1);
  EXPECT_EQ(finding().verdict, Verdict::kWarn) << "a receive thread of 65";
  EXPECT_EQ(checkInterruptThreads("can0", threads("can0"), {.priority = 60}).verdict, Verdict::kPass);
  const auto low = checkInterruptThreads("can0", threads("can0"), {.priority = 75});
  EXPECT_THAT(low.why, HasSubstr("below rc10d's scheduler (75)"));
  EXPECT_THAT(low.fix, HasSubstr("--priority 76   # or a lower priority of scheduler"));
}

TEST_F(SpiHat, AThreadWithoutRealTimePriorityIsTooLow) {
  thread(root, 12, "spi0", 0, 0);
  EXPECT_THAT(finding().why, HasSubstr("spi0 not real-time"));
}

TEST_F(SpiHat, WhatIsSetAlreadyIsLeftAlone) {
  thread(root, 12, "spi0", 70, 1);
  EXPECT_THAT(changes({"can0"}), ElementsAre("can0 irq/57-spi0.0 50"));
}

TEST_F(SpiHat, AThreadOfTwoInterfacesIsChangedOnce) {
  EXPECT_THAT(changes({"can0", "can1"}),
              ElementsAre("can0 spi0 50", "can0 irq/57-spi0.0 50", "can1 irq/58-spi0.1 50"));
}

TEST_F(SpiHat, APriorityThatIsTooHighIsChangedToo) {
  thread(root, 12, "spi0", 99, 1);
  thread(root, 57, "irq/57-spi0.0", 70, 1);
  EXPECT_THAT(changes({"can0"}), ElementsAre("can0 spi0 99"));
}

TEST_F(SpiHat, ThePriorityOfAThreadThatIsNotRealTimeDoesNotCount) {
  thread(root, 12, "spi0", 70, 0);
  thread(root, 57, "irq/57-spi0.0", 70, 1);
  EXPECT_THAT(changes({"can0"}), ElementsAre("can0 spi0 not real-time"));
}

TEST_F(SpiHat, AProgramThatTakesTheNameOfAnInterruptThreadIsNone) {
  process(root, 901, "irq/57-spi0.0", 0x400000, 0, 0);
  process(root, 902, "spi0", 0x400000, 0, 0);
  EXPECT_THAT(changes({"can0"}), ElementsAre("can0 spi0 50", "can0 irq/57-spi0.0 50"));
}

TEST_F(SpiHat, WithPreemptRtTheInterruptOfItsControllerIsAThreadToo) {
  root.link("/sys/class/spi_master/spi0/device", "../../../fe204000.spi");
  thread(root, 40, "irq/40-fe204000.spi", 50, 1);
  thread(root, 41, "irq/41-fe204600.spi", 50, 1);
  EXPECT_THAT(names(threads("can0")), ElementsAre("spi0", "irq/40-fe204000.spi", "irq/57-spi0.0"));
}

TEST_F(SpiHat, ANameThatTheKernelHasCutIsKnown) {
  root.link("/sys/class/spi_master/spi0/device", "../../../fe204000.spi");
  thread(root, 40, "irq/140-fe20400", 50, 1);
  EXPECT_THAT(names(threads("can0")), ElementsAre("spi0", "irq/140-fe20400", "irq/57-spi0.0"));
}

TEST_F(SpiHat, TheSecondThreadOfAnInterruptIsKnown) {
  thread(root, 59, "irq/57-s-spi0.0", 50, 1);
  EXPECT_THAT(names(threads("can0")), ElementsAre("spi0", "irq/57-spi0.0", "irq/57-s-spi0.0"));
}

TEST_F(SpiHat, OnlyCanInterfacesAreListed) { EXPECT_THAT(canInterfaces(files), ElementsAre("can0", "can1")); }

TEST_F(SpiHat, OneThatIsDownGetsItsInterruptThreadLater) {
  const auto processes = readProcesses(files);
  EXPECT_THAT(missingThreads("can0", files, processes), IsEmpty());
  EXPECT_THAT(missingThreads("can1", files, processes), HasSubstr("is down"));
}

TEST(InterruptThreads, AnInterruptMayHaveTheNameOfItsInterface) {
  HostRoot root;
  root.link("/sys/class/net/can0/device", "../../../0000:00:05.0");
  thread(root, 10, "irq/10-can0", 50, 1);
  thread(root, 11, "irq/10-can01", 50, 1);
  const auto files = root.files();
  EXPECT_THAT(names(threadsOf("can0", files, readProcesses(files))), ElementsAre("irq/10-can0"));
}

TEST(InterruptThreads, AVirtualInterfaceHasNone) {
  HostRoot root;
  root.write("/sys/class/net/vcan0/flags", "0xc1");
  thread(root, 57, "irq/57-vcan0", 50, 1);
  const auto files = root.files();
  const auto processes = readProcesses(files);
  EXPECT_THAT(threadsOf("vcan0", files, processes), IsEmpty());
  EXPECT_EQ(checkInterruptThreads("vcan0", {}, {.priority = 65}).verdict, Verdict::kPass);
  EXPECT_THAT(missingThreads("vcan0", files, processes), HasSubstr("has none"));
}

TEST(InterruptThreads, AnInterfaceThatIsNotThereHasNone) {
  HostRoot root;
  const auto files = root.files();
  EXPECT_THAT(canInterfaces(files), IsEmpty());
  EXPECT_THAT(priorityChanges({"can0"}, 70, files, {}), IsEmpty());
}

}  // namespace
}  // namespace rc10::doctor::interrupt_threads_test
