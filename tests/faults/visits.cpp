#include "faults/visits.hpp"

#include <fmt/format.h>

#include "link/words.hpp"

namespace rc10::test {

const char* wordOf(FallbackAction action) { return kFallbackWords[static_cast<std::size_t>(action)].data(); }

const char* wordOf(Told::Law law) {
  constexpr std::array<const char*, 7> kWords{"off",    "effort", "velocity", "angle",
                                              "spring", "duty",   "brake"};
  return kWords[static_cast<std::size_t>(law)];
}

void Visits::add(const Visits& other) {
  const auto sum = [](auto& to, const auto& from) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
  };
  ticks += other.ticks;
  stops += other.stops;
  stalls += other.stalls;
  probes += other.probes;
  unread_after_pauses += other.unread_after_pauses;
  by_modules += other.by_modules;
  slewed += other.slewed;
  bounded += other.bounded;
  first_angles += other.first_angles;
  turns += other.turns;
  zeros += other.zeros;
  sum(slewed_fields, other.slewed_fields);
  sum(softened, other.softened);
  reduced += other.reduced;
  reduced_efforts += other.reduced_efforts;
  kept += other.kept;
  held_far += other.held_far;
  held_for_nobody += other.held_for_nobody;
  homing += other.homing;
  homed += other.homed;
  scans += other.scans;
  scanned += other.scanned;
  scans_refused += other.scans_refused;
  questions += other.questions;
  driven += other.driven;
  alone += other.alone;
  rearmed += other.rearmed;
  for (const auto& [name, visited] : other.motors) {
    motors[name].active += visited.active;
    motors[name].foreign += visited.foreign;
    sum(motors[name].laws, visited.laws);
    sum(motors[name].modes, visited.modes);
    motors[name].supported = visited.supported;
  }
  sum(robot, other.robot);
  sum(status, other.status);
  sum(faults, other.faults);
  sum(fallbacks, other.fallbacks);
}

std::string Visits::text() const {
  const auto millions = [](std::uint64_t n) { return static_cast<double>(n) / 1e6; };
  std::string out = "robot, ticks:";
  for (std::size_t i = 0; i < robot.size(); ++i)
    out += fmt::format(" {} {}", toString(static_cast<RobotStatus>(i)), robot[i]);
  out += "\nmotors, million ticks:";
  for (std::size_t i = 0; i < status.size(); ++i)
    out += fmt::format(" {} {:.3f}", toString(static_cast<MotorStatus>(i)), millions(status[i]));
  out += fmt::format("\nmoved by, million ticks: a target {:.3f}", millions(driven));
  for (std::size_t i = 0; i < fallbacks.size(); ++i)
    out += fmt::format(", {} {:.3f}", wordOf(static_cast<FallbackAction>(i)), millions(fallbacks[i]));
  out += "\nfaults:";
  const char* comma = "";
  for (std::size_t i = 1; i < faults.size(); ++i) {
    if (faults[i] == 0) continue;
    out += fmt::format("{} {} {}", comma, link::faultText(static_cast<std::int32_t>(i)), faults[i]);
    comma = ",";
  }
  for (const auto& [name, visited] : motors) {
    out += fmt::format("\n{}, thousand ticks: ACTIVE {}, told", name, visited.active / 1000);
    for (std::size_t law = 1; law < visited.laws.size(); ++law)
      out += fmt::format(" {} {}", wordOf(static_cast<Told::Law>(law)), visited.laws[law] / 1000);
    out += "; asked for";
    for (std::size_t mode = 1; mode < visited.modes.size(); ++mode)
      if (visited.supported.contains(static_cast<ControlMode>(mode)))
        out += fmt::format(" {} {}", toString(static_cast<ControlMode>(mode)), visited.modes[mode] / 1000);
  }
  out += fmt::format("\nof modules, thousand ticks: {}", by_modules / 1000);
  out += fmt::format(
      "\njudged, ticks: slew limits {}, soft limits {}, reduced mode {}, reduced efforts {}, "
      "fallbacks that keep a motor {}, homing {}",
      slewed, bounded, reduced, reduced_efforts, kept, homing);
  out +=
      fmt::format("\nslew limits of speeds {}, places {}, velocity feed-forwards {}, torque feed-forwards {}",
                  slewed_fields[1], slewed_fields[2], slewed_fields[3], slewed_fields[4]);
  out += fmt::format(
      "\nsoft starts of efforts {}, speeds {}, places {}, velocity feed-forwards {}, torque feed-forwards {}",
      softened[0], softened[1], softened[2], softened[3], softened[4]);
  out += fmt::format("\nfirst angles {}, turns at power-up {}, zeros {}", first_angles, turns, zeros);
  out += fmt::format("\nheld by loops of rc10d, and far away, samples: {}", held_far);
  out += fmt::format("\nheld for nobody, thousand ticks: {}", held_for_nobody / 1000);
  out += fmt::format("\nhomings that found their end: {}", homed);
  out += fmt::format("\nscans: {} begun, {} made to their end, {} refused; {} questions judged", scans,
                     scanned, scans_refused, questions);
  out += fmt::format("\nenabled alone, ticks: {}", alone);
  out += fmt::format("\nbuses without echoes: {}, probed {} times", stalls, probes);
  out += fmt::format("\nticks of motors that only a pause made stale: {}", unread_after_pauses);
  out += fmt::format("\ngroups enabled again by themselves: {}; orderly ends: {}\n", rearmed, stops);
  return out;
}

namespace {

using Counts = std::vector<std::pair<std::string, std::uint64_t>>;

[[nodiscard]] std::string zerosOf(const Counts& counts) {
  std::string out;
  for (const auto& [name, count] : counts)
    if (count == 0) out += (out.empty() ? "" : ", ") + name;
  return out;
}

// Faults that the chaos provokes several times in an hour.
constexpr std::array kProvoked{FaultCode::kOverspeed, FaultCode::kOverheated,        FaultCode::kEncoderJump,
                               FaultCode::kRunaway,   FaultCode::kForeignCommands,   FaultCode::kReducedSpeed,
                               FaultCode::kNotAtRest, FaultCode::kDriveCommunication};

}  // namespace

std::string Visits::idle() const {
  Counts counts{{"slew limits", slewed},
                {"soft limits", bounded},
                {"zeros", zeros},
                {"reduced mode", reduced},
                {"fallbacks that keep a motor", kept},
                {"targets", driven},
                {"modules", by_modules},
                {"stalled buses", stalls},
                {"probes", probes},
                {"scans", scans}};
  return zerosOf(counts);
}

std::string Visits::idleInAnHour() const {
  Counts counts{{"a motor enabled alone", alone},
                {"a group enabled again", rearmed},
                {"orderly ends", stops},
                {"first angles", first_angles},
                {"turns at power-up", turns},
                {"reduced efforts", reduced_efforts},
                {"a hold far from its place", held_far},
                {"a held direction", held_for_nobody},
                {"homing", homing},
                {"a homing that found its end", homed},
                {"a scan made to its end", scanned},
                {"a refused scan", scans_refused},
                {"questions of scans", questions},
                {"pauses", unread_after_pauses}};
  // The first of both is judged by rules of its own: an effort, in every frame.
  constexpr std::array kFields{"efforts", "speeds", "places", "velocity feed-forwards",
                               "torque feed-forwards"};
  for (std::size_t field = 0; field < kFields.size(); ++field) {
    if (field > 0) counts.emplace_back(std::string{"slew limits of "} + kFields[field], slewed_fields[field]);
    counts.emplace_back(std::string{"soft starts of "} + kFields[field], softened[field]);
  }
  for (std::size_t action = 1; action < fallbacks.size(); ++action)
    counts.emplace_back(wordOf(static_cast<FallbackAction>(action)), fallbacks[action]);
  for (const auto code : kProvoked)
    counts.emplace_back(link::faultText(static_cast<std::int32_t>(code)),
                        faults[static_cast<std::size_t>(code)]);
  for (const auto& [name, visited] : motors) {
    counts.emplace_back(name, visited.active);
    std::uint64_t told = 0;
    for (const auto count : visited.laws) told += count;
    counts.emplace_back(name + " in motion", told);
  }
  // Some motors have no reference for most of the time: of modes that need one, each family's.
  std::map<std::string, std::uint64_t> of_families;
  for (const auto& [name, visited] : motors) {
    of_families[name.substr(0, name.find(' ')) + " commanded by somebody else"] += visited.foreign;
    for (int number = 1; number < kControlModeCount; ++number) {
      const auto mode = static_cast<ControlMode>(number);
      if (!visited.supported.contains(mode)) continue;
      const auto followed = visited.modes[static_cast<std::size_t>(number)];
      of_families[fmt::format("{} in {}", name.substr(0, name.find(' ')), toString(mode))] += followed;
      if (!needsReference(mode)) counts.emplace_back(fmt::format("{} in {}", name, toString(mode)), followed);
    }
  }
  counts.insert(counts.end(), of_families.begin(), of_families.end());
  const std::string short_run = idle();
  const std::string whole = zerosOf(counts);
  return short_run.empty() || whole.empty() ? short_run + whole : short_run + ", " + whole;
}

}  // namespace rc10::test
