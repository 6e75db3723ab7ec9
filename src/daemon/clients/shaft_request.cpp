#include "daemon/clients/shaft_request.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/nearest.hpp"
#include "config/keys/key_table.hpp"
#include "config/keys/value_check.hpp"
#include "config/yaml/number_text.hpp"

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

[[nodiscard]] std::span<const link::NamedValue> valuesOf(const link::Request& request) {
  return std::span(request.values).first(std::min<std::size_t>(request.value_count, link::kMaxValues));
}

[[nodiscard]] Error noShaft(std::string_view operation, std::string_view motor) {
  return {fmt::format(
      "{}: '{}' has a real drive, or one of rc10-sim: this is for shafts of buses with `type: sim`",
      operation, motor)};
}

}  // namespace

Result<ShaftOrder> parseHand(const link::Request& request, std::string_view motor,
                             const std::optional<SimulatedDrive>& drive) {
  if (!drive) return tl::unexpected(noShaft("hand", motor));
  std::array<double, kValues.size()> values{};
  for (std::size_t i = 0; i < kValues.size(); ++i) values.at(i) = kValues.at(i).otherwise;
  for (const auto& given : valuesOf(request)) {
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
  return ShaftOrder{.of = *drive,
                    .act = sim::Hand{.by_deg = direction * values.at(kBy),
                                     .speed_rpm = values.at(kSpeed),
                                     .torque_nm = values.at(kTorque),
                                     .hold = std::chrono::duration_cast<Duration>(
                                         std::chrono::duration<double>(values.at(kHold)))}};
}

Result<ShaftOrder> parseLoad(const link::Request& request, std::string_view motor,
                             const std::optional<SimulatedDrive>& drive) {
  if (!drive) return tl::unexpected(noShaft("load", motor));
  const auto given = valuesOf(request);
  sim::LoadChange change{.back = given.empty()};
  for (const auto& value : given) {
    const auto& figures = sim::kLoadFigures;
    const auto figure = std::find_if(figures.begin(), figures.end(),
                                     [&](const auto& each) { return each.name == value.name.view(); });
    const Key* key = figure == figures.end() ? nullptr : findKey(kLoadChangeSection, figure->name);
    if (key == nullptr) {
      std::vector<std::string_view> names;
      names.reserve(figures.size());
      for (const auto& each : figures) names.push_back(each.name);
      return fail(fmt::format("load: there is no value '{}': {}{}", value.name.view(), fmt::join(names, ", "),
                              didYouMean(value.name.view(), names)));
    }
    if (!std::isfinite(value.value)) return fail(fmt::format("load: {}: is not a number", figure->name));
    if (const auto why = whyOutOfRange(value.value, *key); !why.empty())
      return fail(fmt::format("load: {}: {}", figure->name, why));
    auto& place = change.values.at(static_cast<std::size_t>(figure - figures.begin()));
    if (place) return fail(fmt::format("load: {}: is given twice; keep one", figure->name));
    place = static_cast<float>(value.value);
  }
  sim::MotorLoad arm;
  arm.payload_at_m = drive->payload_at_m;
  arm = change.of(arm, arm);
  if (arm.payload_kg > 0.0F && arm.payload_at_m <= 0.0F)
    return fail(
        "load: payload_kg: has no arm to hang on; give payload_at_m too, its distance from the shaft");
  return ShaftOrder{.of = *drive, .act = change};
}

std::string shaftInWords(const ShaftOrder& order, std::string_view motor) {
  const auto* change = std::get_if<sim::LoadChange>(&order.act);
  if (change == nullptr) return fmt::format("hand: turns {}", motor);
  if (change->back) return fmt::format("load: {}: as at the start", motor);
  std::vector<std::string> changes;
  for (std::size_t i = 0; i < sim::kLoadFigures.size(); ++i) {
    if (const auto value = change->values.at(i))
      changes.push_back(fmt::format("{} {}", sim::kLoadFigures.at(i).name, numberText(*value)));
  }
  return fmt::format("load: {}: {}", motor, fmt::join(changes, ", "));
}

}  // namespace rc10
