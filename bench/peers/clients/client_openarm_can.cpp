// Four DM4310 by openarm_can: its own calls, at 1 kHz with an absolute sleep, SCHED_FIFO 60 as rc10d.
// bench/peers/run --openarm-can builds it with the user's checkout.
#include <sched.h>

#include <cstdint>
#include <ctime>
#include <vector>

#include <openarm/can/socket/openarm.hpp>
#include <openarm/damiao_motor/dm_motor_constants.hpp>

namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;
constexpr std::int64_t kSecondNs = 1'000'000'000;

}  // namespace

int main() {
  namespace dm = openarm::damiao_motor;
  const sched_param priority{.sched_priority = 60};
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0) return 1;
  openarm::can::socket::OpenArm arm("vcan0", false);
  arm.init_arm_motors(std::vector(4, dm::MotorType::DM4310), {1, 2, 3, 4}, {0x11, 0x12, 0x13, 0x14});
  arm.set_callback_mode_all(dm::CallbackMode::IGNORE);
  arm.enable_all();
  arm.recv_all(2000);
  arm.set_callback_mode_all(dm::CallbackMode::STATE);
  const std::vector targets(4, dm::MITParam{2, 1, 0.17, 0, 0});
  timespec next{};
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (;;) {
    arm.get_arm().mit_control_all(targets);
    arm.recv_all(500);
    const std::int64_t ns = next.tv_nsec + kPeriodNs;
    next.tv_sec += ns / kSecondNs;
    next.tv_nsec = ns % kSecondNs;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr);
  }
}
