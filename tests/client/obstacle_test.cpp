#include "client/obstacle.hpp"

#include <gtest/gtest.h>

#include <string_view>

#include "app/event_code.hpp"

namespace rc10::client::obstacle_test {
namespace {

link::Event event(EventCode code, std::string_view source, std::string_view client = {}) {
  link::Event out;
  out.code = static_cast<std::int32_t>(code);
  out.source = source;
  out.client = client;
  out.text = std::string_view{"why"};
  return out;
}

TEST(Obstacle, ARefusalOfTheMotorOrOfTheClientsMessageIsItsText) {
  EXPECT_EQ(refusalText(event(EventCode::kSetpointSkipped, "knee"), "knee", "me"), "why");
  EXPECT_EQ(refusalText(event(EventCode::kNotOwner, "knee"), "knee", "me"), "why");
  EXPECT_EQ(refusalText(event(EventCode::kCommandRefused, "robot", "me"), "knee", "me"), "why");
}

TEST(Obstacle, OtherMotorsOtherClientsAndOtherEventsAreNoRefusal) {
  EXPECT_EQ(refusalText(event(EventCode::kSetpointSkipped, "hip"), "knee", "me"), "");
  EXPECT_EQ(refusalText(event(EventCode::kCommandRefused, "robot", "other"), "knee", "me"), "");
  EXPECT_EQ(refusalText(event(EventCode::kMotorFault, "knee", "me"), "knee", "me"), "");
}

}  // namespace
}  // namespace rc10::client::obstacle_test
