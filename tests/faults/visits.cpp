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
    sum(motors[name].laws, visited.laws);
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
  }
  out += fmt::format("\nof modules, thousand ticks: {}", by_modules / 1000);
  out += fmt::format("\njudged, ticks: slew limits {}, soft limits {}, reduced mode {}, homing {}", slewed,
                     bounded, reduced, homing);
  out +=
      fmt::format("\nslew limits of speeds {}, places {}, velocity feed-forwards {}, torque feed-forwards {}",
                  slewed_fields[1], slewed_fields[2], slewed_fields[3], slewed_fields[4]);
  out += fmt::format(
      "\nsoft starts of efforts {}, speeds {}, places {}, velocity feed-forwards {}, torque feed-forwards {}",
      softened[0], softened[1], softened[2], softened[3], softened[4]);
  out += fmt::format("\nfirst angles {}, turns at power-up {}, zeros {}", first_angles, turns, zeros);
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

std::string Visits::idle() const {
  std::string out;
  for (const auto& [name, visited] : motors) {
    std::uint64_t told = 0;
    for (const auto count : visited.laws) told += count;
    if (visited.active == 0 || told == 0) out += (out.empty() ? "" : ", ") + name;
  }
  if (scanned == 0) out += out.empty() ? "a scan" : ", a scan";
  if (homed == 0) out += out.empty() ? "a homing" : ", a homing";
  if (held_for_nobody == 0) out += out.empty() ? "a held direction" : ", a held direction";
  return out;
}

}  // namespace rc10::test
