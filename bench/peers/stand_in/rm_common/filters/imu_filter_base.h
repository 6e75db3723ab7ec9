// In the place of rm_common's IMU filter: no robot of the bench has an IMU.
#pragma once

#include <ros/ros.h>

namespace rm_common {

class ImuFilterBase {
 public:
  template <typename... Values>
  void update(const Values&... /*values*/) {}
};

}  // namespace rm_common
