#include "web/signal_names.hpp"

#include <algorithm>
#include <span>

namespace rc10::web {
namespace {

template <typename Range, typename Name>
std::optional<std::uint16_t> placeOf(const Range& range, std::size_t count, std::string_view wanted,
                                     Name name) {
  const auto end = range.begin() + static_cast<std::ptrdiff_t>(std::min(count, range.size()));
  const auto found = std::find_if(range.begin(), end, [&](const auto& one) { return name(one) == wanted; });
  if (found == end) return std::nullopt;
  return static_cast<std::uint16_t>(found - range.begin());
}

constexpr auto kView = [](const link::Name& name) { return name.view(); };

}  // namespace

std::optional<link::TraceSignal> traceSignalOf(std::string_view name, const link::Welcome& robot,
                                               const std::vector<link::ModuleInfo>& modules) {
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const auto owner = name.substr(0, dot);
  const auto value = name.substr(dot + 1);
  if (const auto motor = placeOf(robot.motors, robot.motor_count, owner,
                                 [](const link::MotorInfo& info) { return info.name.view(); })) {
    const auto reading = placeOf(link::kTraceReadings, link::kTraceReadings.size(), value,
                                 [](std::string_view reading_name) { return reading_name; });
    if (!reading) return std::nullopt;
    return link::TraceSignal{link::TraceSource::kMotor, *motor, *reading};
  }
  const auto module = placeOf(robot.modules, robot.module_count, owner, kView);
  if (!module) return std::nullopt;
  const auto info =
      std::find_if(modules.begin(), modules.end(), [&](const auto& m) { return m.module == *module; });
  if (info == modules.end()) return std::nullopt;
  const auto outputs = std::span{info->names}.subspan(info->input_count, info->output_count);
  const auto output = placeOf(outputs, outputs.size(), value, kView);
  if (!output) return std::nullopt;
  return link::TraceSignal{link::TraceSource::kModule, *module, *output};
}

}  // namespace rc10::web
