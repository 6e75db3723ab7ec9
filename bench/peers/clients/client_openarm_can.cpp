// Four DM4310 by openarm_can: its own calls, at 1 kHz with an absolute sleep, SCHED_FIFO 60 as rc10d.
// bench/peers/run --openarm-can builds it with the user's checkout.
#include <vector>

#include <openarm/can/socket/openarm.hpp>
#include <openarm/damiao_motor/dm_motor_constants.hpp>

#include "../grid.hpp"

int main() {
  namespace dm = openarm::damiao_motor;
  rc10::peers::schedule(SCHED_FIFO, rc10::peers::kPriority);
  openarm::can::socket::OpenArm arm("vcan0", false);
  arm.init_arm_motors(std::vector(4, dm::MotorType::DM4310), {1, 2, 3, 4}, {0x11, 0x12, 0x13, 0x14});
  arm.set_callback_mode_all(dm::CallbackMode::IGNORE);
  arm.enable_all();
  arm.recv_all(2000);
  arm.set_callback_mode_all(dm::CallbackMode::STATE);
  const std::vector targets(4, dm::MITParam{2, 1, 0.17, 0, 0});
  rc10::peers::Grid grid;
  do {
    arm.get_arm().mit_control_all(targets);
    arm.recv_all(500);
  } while (grid.sleep());
  grid.printLateness();
}
