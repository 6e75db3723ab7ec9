#include "daemon/clients/gain_request.hpp"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "config/yaml/number_text.hpp"
#include "link/until_its_end.hpp"

namespace rc10 {

Result<void> checkHasGains(std::string_view motor, const MotorLoops& loops) {
  if (loops.onHost()) return {};
  return fail(fmt::format(
      "{}: rc10d closes no loop of {}: its drive does, with its own gains; see the page of its family "
      "(docs/motors.md), `rc10ctl configure-drive {} --list`, or its maker's tool",
      motor, loops.model.empty() ? "this motor" : "the " + loops.model, motor));
}

Result<GainChanges> parseGains(const link::Request& request, const MotorLoops& loops) {
  GainChanges changes;
  const auto count = std::min<std::size_t>(request.value_count, link::kMaxValues);
  for (const auto& value : std::span(request.values).first(count)) {
    if (value.name.view() == link::kRestoreAtEnd) continue;
    const auto change = gainChange(value.name.view(), value.value, loops);
    if (!change) return tl::unexpected(change.error());
    const auto given = std::span(changes.values).first(changes.count);
    if (std::any_of(given.begin(), given.end(), [&](const auto& each) { return each.gain == change->gain; }))
      return fail(fmt::format("{}: is given twice; keep one", value.name.view()));
    changes.values[changes.count++] = *change;
  }
  if (changes.count == 0) return fail("name a gain and its value, such as velocity_pid.kp_a_per_rpm");
  return changes;
}

std::string applyGains(const GainChanges& changes, MotorLoops& loops) {
  std::string text;
  const auto keys = gainKeysOf(loops);
  for (const auto& change : std::span(changes.values).first(changes.count)) {
    float* value = gainIn(loops.config, change.gain);
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const GainKey& each) { return each.gain == change.gain; });
    if (value == nullptr || key == keys.end()) continue;
    text += fmt::format("{}{} {} -> {}", text.empty() ? "" : ", ", key->path(), numberText(*value),
                        numberText(change.value));
    *value = change.value;
  }
  return text;
}

std::string leftGains(std::string_view motor, std::string_view client, const MotorLoops& loops,
                      const GainChanges& before) {
  std::string gains;
  std::string command = fmt::format("rc10ctl gains {}", motor);
  const auto keys = gainKeysOf(loops);
  for (const auto& change : std::span(before.values).first(before.count)) {
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const GainKey& each) { return each.gain == change.gain; });
    if (key == keys.end()) continue;
    const auto value = numberText(change.value);
    gains += fmt::format("{}{} is {}, not {}", gains.empty() ? "" : ", ", key->path(),
                         numberText(gainOf(loops.config, change.gain)), value);
    command += fmt::format(" {}={}", key->path(), value);
  }
  return fmt::format("{}: gains that '{}' tried could not be set back: {}: `{}`", motor, client, gains,
                     command);
}

void tellGains(const MotorLoops& loops, link::Response& response) {
  for (const auto& gain : gainKeysOf(loops)) {
    if (response.value_count == link::kMaxValues) return;
    // As many digits as it has: 0.1, not the double nearest to the float.
    const std::string text = numberText(gainOf(loops.config, gain.gain));
    response.values[response.value_count++] = {.name = std::string_view{gain.path()},
                                               .value = parseNumber(text).value_or(0.0)};
  }
}

}  // namespace rc10
