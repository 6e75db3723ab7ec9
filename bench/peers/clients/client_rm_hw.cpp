// 2 x 4 M3508 by the CAN layer of rm_hw: its own calls, at 1 kHz with an absolute sleep, SCHED_FIFO 60 as
// rc10d. ROS and its controllers are left out: the torques are constant. bench/peers/run --rm-hw builds it
// with the user's checkout of rm_control.
#include <ros/ros.h>

#include <array>
#include <cmath>
#include <string>
#include <unordered_map>

#include <rm_hw/hardware_interface/can_bus.h>

#include "../grid.hpp"

namespace {

constexpr int kFirstId = 0x201;
constexpr double kAmperePerCount = 20.0 / 16384.0;
constexpr double kNewtonMetrePerAmpere = 0.0156;  // of the rotor
constexpr double kEffortNm = 0.01;

/// Four M3508 on a bus, and the tables that the CAN layer reads and writes.
class Wheels {
 public:
  explicit Wheels(const std::string& interface)
      : bus_(interface, {&coefficients_, &actuators_, &imus_, &tofs_}, rc10::peers::kPriority) {
    rm_hw::ActCoeff& m3508 = coefficients_["rm_3508"];
    m3508.act2pos = 2.0 * M_PI / 8192.0;
    m3508.act2vel = 2.0 * M_PI / 60.0;
    m3508.act2effort = kAmperePerCount * kNewtonMetrePerAmpere;
    m3508.effort2act = 1.0 / m3508.act2effort;
    m3508.max_out = 16384.0;
    for (std::size_t i = 0; i < filters_.size(); ++i) {
      rm_hw::ActData wheel{};
      wheel.name = "wheel" + std::to_string(i);
      wheel.type = "rm_3508";
      wheel.lp_filter = &filters_[i];
      wheel.exe_effort = kEffortNm;
      actuators_[kFirstId + static_cast<int>(i)] = wheel;
    }
  }

  void cycle() {
    bus_.read(ros::Time::now());
    bus_.write();
  }

 private:
  std::array<LowPassFilter, 4> filters_;
  std::unordered_map<std::string, rm_hw::ActCoeff> coefficients_;
  std::unordered_map<int, rm_hw::ActData> actuators_;
  std::unordered_map<int, rm_hw::ImuData> imus_;
  std::unordered_map<int, rm_hw::TofData> tofs_;
  rm_hw::CanBus bus_;
};

}  // namespace

int main() {
  rc10::peers::schedule(SCHED_FIFO, rc10::peers::kPriority);
  Wheels left("vcan0");
  Wheels right("vcan1");
  rc10::peers::Grid grid;
  do {
    left.cycle();
    right.cycle();
  } while (grid.sleep());
  grid.printLateness();
}
