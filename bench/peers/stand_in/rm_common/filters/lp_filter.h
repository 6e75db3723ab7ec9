// In the place of rm_common's low-pass filter, which needs more of ROS than a clock.
#pragma once

#include <ros/ros.h>

class LowPassFilter {
 public:
  void input(double value) { value_ += kShare * (value - value_); }
  void input(double value, ros::Time /*time*/) { input(value); }
  [[nodiscard]] double output() const { return value_; }

 private:
  static constexpr double kShare = 0.25;
  double value_ = 0.0;
};
