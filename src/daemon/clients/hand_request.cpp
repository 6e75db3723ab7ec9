#include "daemon/clients/hand_request.hpp"

#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "app/nearest.hpp"

namespace rc10 {
namespace {

/// A value of the request.
struct HandValue {
  std::string_view name;
  double low;
  double high;
  double otherwise;
};
// Ranges of a person's hand: some turns, not minutes.
constexpr std::array<HandValue, 4> kValues{{{"by_deg", -36'000.0, 36'000.0, 0.0},
                                            {"speed_rpm", 0.1, 600.0, 30.0},
                                            {"torque_nm", 0.01, 1000.0, 5.0},
                                            {"hold_s", 0.0, 60.0, 0.0}}};
enum Value : std::size_t { kBy, kSpeed, kTorque, kHold };

}  // namespace

Result<HandOrder> parseHand(const link::Request& request, std::string_view motor,
                            const std::optional<SimulatedDrive>& drive) {
  if (!drive) {
    return fail(
        fmt::format("hand: '{}' has a real drive, or one of rc10-sim: a hand turns shafts of buses "
                    "with `type: sim`",
                    motor));
  }
  std::array<double, kValues.size()> values{};
  for (std::size_t i = 0; i < kValues.size(); ++i) values.at(i) = kValues.at(i).otherwise;
  for (std::size_t i = 0; i < request.value_count; ++i) {
    const auto& given = request.values.at(i);
    std::size_t which = 0;
    while (which < kValues.size() && kValues.at(which).name != given.name.view()) ++which;
    if (which == kValues.size()) {
      return fail(fmt::format("hand: there is no value '{}': by_deg, speed_rpm, torque_nm and hold_s{}",
                              given.name.view(),
                              didYouMean(given.name.view(), {"by_deg", "speed_rpm", "torque_nm", "hold_s"})));
    }
    const auto& known = kValues.at(which);
    if (!(given.value >= known.low && given.value <= known.high)) {
      return fail(fmt::format("hand: {}: {} is out of range; use {} to {}", known.name, given.value,
                              known.low, known.high));
    }
    values.at(which) = given.value;
  }
  // The request speaks of the angle that the motor reports.
  const double direction = drive->direction < 0 ? -1.0 : 1.0;
  return HandOrder{.of = *drive,
                   .hand = {.by_deg = direction * values.at(kBy),
                            .speed_rpm = values.at(kSpeed),
                            .torque_nm = values.at(kTorque),
                            .hold = std::chrono::duration_cast<Duration>(
                                std::chrono::duration<double>(values.at(kHold)))}};
}

}  // namespace rc10
