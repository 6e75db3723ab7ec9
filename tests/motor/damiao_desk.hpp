#pragma once

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "support/damiao_motors.hpp"

namespace rc10::test::damiao_desk {

using std::chrono::milliseconds;

inline constexpr DamiaoScale kDm4310{12.5, 30.0, 10.0};
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline bool isSpecial(const CanFrame& frame, damiao::Special command) {
  return frame.length == 8 && frame.data[0] == 0xFF && frame.data[6] == 0xFF &&
         frame.data[7] == static_cast<std::uint8_t>(command);
}

inline bool isDisable(const CanFrame& frame) { return isSpecial(frame, damiao::Special::kDisable); }

inline SpringLaw mitOf(const std::vector<CanFrame>& sent) {
  EXPECT_GE(sent.size(), 1U);
  if (sent.empty()) return {};  // a question about a register may follow
  return damiao::readMit(std::span(sent[0].data).first<8>(), kDm4310);
}

inline damiao::State stateAt(double rad, double rad_s = 0.0, std::uint8_t status = 1) {
  return {.status = status,
          .position = damiao::toCode(rad, 12.5, 16),
          .velocity = damiao::toCode(rad_s, 30.0, 12),
          .torque = 0x800,
          .drive_temperature = 30,
          .winding_temperature = 31};
}

struct EnabledDesk : DamiaoDesk {
  explicit EnabledDesk(MotorSettings settings = damiaoSettingsOf()) : DamiaoDesk(std::move(settings)) {
    EXPECT_TRUE(enable());
  }
};

}  // namespace rc10::test::damiao_desk
