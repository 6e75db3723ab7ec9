// In the place of ROS 1 for the CAN layer of rm_hw: its clock, and messages that nobody reads.
#pragma once

#include <sys/ioctl.h>
#include <unistd.h>

#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#include <boost/bind.hpp>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace ros {

class Duration {
 public:
  explicit Duration(double seconds = 0.0) : seconds_(seconds) {}
  [[nodiscard]] double toSec() const { return seconds_; }
  void sleep() const { ::usleep(static_cast<useconds_t>(seconds_ * 1e6)); }

 private:
  double seconds_;
};

class Time {
 public:
  Time() = default;
  static Time now() {
    timespec time{};
    clock_gettime(CLOCK_REALTIME, &time);
    return Time{time.tv_sec * 1'000'000'000 + time.tv_nsec};
  }
  friend Duration operator-(Time a, Time b) { return Duration{static_cast<double>(a.ns_ - b.ns_) * 1e-9}; }

 private:
  explicit Time(std::int64_t ns) : ns_(ns) {}
  std::int64_t ns_ = 0;
};

inline bool ok() { return true; }

}  // namespace ros

#define ROS_INFO(...) static_cast<void>(0)
#define ROS_ERROR(...) static_cast<void>(0)
#define ROS_ERROR_THROTTLE(...) static_cast<void>(0)
#define ROS_DEBUG_THROTTLE(...) static_cast<void>(0)
#define ROS_ERROR_STREAM_ONCE(text) static_cast<void>(0)
