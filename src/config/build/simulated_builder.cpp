#include "config/build/simulated_builder.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "config/yaml/number_text.hpp"
#include "sim/load_change.hpp"

namespace rc10 {
namespace {

[[nodiscard]] Duration secondsOf(double value_s) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(value_s));
}

void checkStops(MotorParse& in, const Settings& simulated) {
  const sim::MotorLoad& load = in.draft.config.simulated;
  const bool below = load.initial_angle_deg < load.stop_min_deg;
  const bool beyond = load.initial_angle_deg > load.stop_max_deg;
  if (load.stop_min_deg >= load.stop_max_deg || (!below && !beyond)) return;
  const auto initial = simulated.find("initial_angle_deg");
  const auto wrong = initial ? initial : simulated.find(below ? "stop_min_deg" : "stop_max_deg");
  if (!wrong) return;
  in.problems.error(wrong->place(), wrong->path,
                    "the shaft begins at initial_angle_deg, beyond its stops; change one of them");
}

/// A payload on the axis weighs nothing. `load`: as it is with the section.
void checkPayload(MotorParse& in, const Settings& section, const sim::MotorLoad& load) {
  const auto payload = section.find("payload_kg");
  if (!payload || load.payload_kg <= 0.0F || load.payload_at_m > 0.0F) return;
  in.problems.error(payload->place(), payload->path,
                    "has no arm to hang on; add payload_at_m, its distance from the shaft in m");
}

/// Reads `simulated.changes`.
class PlanReader {
 public:
  PlanReader(MotorParse& in, const Settings& simulated)
      : in_(in), simulated_(simulated), load_(in.draft.config.simulated) {}

  void read() {
    const auto given = simulated_.find("changes");
    for (std::size_t i = 0; given && i < given->node->items.size(); ++i) {
      const YamlNode& node = given->node->items[i];
      if (!node.refused) readStep(node, joinPath(given->path, i));
    }
    readRepeat(given.has_value());
  }

 private:
  void readStep(const YamlNode& node, const std::string& path) {
    const Settings section{{{&node, path}}};
    sim::LoadPlan::Step step;
    double after_s = 0.0;
    section.read("after_s", after_s);
    step.after = secondsOf(after_s);
    for (std::size_t i = 0; i < sim::kLoadFigures.size(); ++i) {
      const auto value = section.number(sim::kLoadFigures[i].name);
      if (value) step.change.values[i] = static_cast<float>(*value);
    }
    // A key that is unknown was to change something, and is told by itself.
    if (node.entries.size() <= 1)
      in_.problems.error(node.place, path, "changes nothing; add what changes, such as payload_kg: 1");
    checkOrder(section, step.after);
    load_ = step.change.of(load_, in_.draft.config.simulated);
    checkPayload(in_, section, load_);
    plan().steps.push_back(step);
  }

  void checkOrder(const Settings& section, Duration after) {
    const auto given = section.find("after_s");
    if (!given || plan().steps.empty() || after > plan().steps.back().after) return;
    in_.problems.error(
        given->place(), given->path,
        given->text() + " s is not after the change before it; write them in the order of time");
  }

  void readRepeat(bool has_changes) {
    const auto given = simulated_.find("changes_repeat_s");
    if (!given) return;
    plan().repeat = secondsOf(simulated_.number("changes_repeat_s").value_or(0.0));
    if (!has_changes && !simulated_.mentions("changes")) {
      in_.problems.error(given->place(), given->path,
                         "there are no changes to repeat; add them, or remove it");
    } else if (!plan().steps.empty() && plan().repeat <= plan().steps.back().after) {
      in_.problems.error(given->place(), given->path,
                         given->text() + " s is not after the last change; use more than its after_s");
    }
  }

  [[nodiscard]] sim::LoadPlan& plan() { return in_.draft.config.load_plan; }

  MotorParse& in_;
  const Settings& simulated_;
  sim::MotorLoad load_;  ///< As the changes so far leave it.
};

}  // namespace

void readSimulated(MotorParse& in) {
  const Settings simulated = in.settings.section("simulated");
  sim::MotorLoad& load = in.draft.config.simulated;
  for (const auto& figure : sim::kLoadFigures) simulated.read(figure.name, load.*figure.field);
  simulated.read("hangs_at_deg", load.hangs_at_deg);
  simulated.read("stop_min_deg", load.stop_min_deg);
  simulated.read("stop_max_deg", load.stop_max_deg);
  simulated.read("initial_angle_deg", load.initial_angle_deg);
  simulated.read("stalled", load.stalled);
  simulated.read("silent", load.silent);
  simulated.read("lost_frames", load.lost_frames);
  in.refuseUnordered(simulated, "stop_min_deg", "stop_max_deg");
  checkStops(in, simulated);
  checkPayload(in, simulated, load);
  PlanReader{in, simulated}.read();
}

void readDriveId(MotorParse& in) {
  const Settings simulated = in.settings.section("simulated");
  const auto given = simulated.find("drive_id");
  if (!given) return;
  int id = in.motor().id;
  simulated.read("drive_id", id);
  in.draft.config.simulated_id = id;
  if (id >= in.traits.min_id && id <= in.traits.max_id) return;
  in.problems.error(given->place(), given->path,
                    given->text() + " is no id of a " + in.modelName() + "; use " +
                        std::to_string(in.traits.min_id) + " to " + std::to_string(in.traits.max_id));
}

}  // namespace rc10
