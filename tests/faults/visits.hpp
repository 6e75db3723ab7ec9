#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/target.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "faults/wire.hpp"
#include "motor/guarding/fallback.hpp"

namespace rc10::test {

/// Counts of one motor: what it was told.
struct MotorVisits {
  std::uint64_t active = 0;                              ///< Ticks.
  std::array<std::uint64_t, 7> laws{};                   ///< Ticks not at rest, by Told::Law.
  std::array<std::uint64_t, kControlModeCount> modes{};  ///< Ticks with a target of this mode.
  std::uint64_t foreign = 0;                             ///< FAULTs for commands of somebody else.
  ModeSet supported;                                     ///< The modes that it has.
};

/// Counts of states seen: the chaos's reach.
struct Visits {
  std::uint64_t ticks = 0;
  std::array<std::uint64_t, 3> robot{};                          ///< Ticks by RobotStatus.
  std::array<std::uint64_t, kMotorStatusCount> status{};         ///< Ticks of motors.
  std::array<std::uint64_t, 64> faults{};                        ///< Number of times each began.
  std::array<std::uint64_t, kFallbackWords.size()> fallbacks{};  ///< Ticks in which one gave torque.
  std::uint64_t kept = 0;        ///< Frames that a fallback had to fill with more than rest.
  std::uint64_t driven = 0;      ///< And ticks in which a target did.
  std::uint64_t by_modules = 0;  ///< Ticks of motors that a module had.
  std::uint64_t alone = 0;       ///< Ticks in which one motor was enabled alone.
  std::uint64_t rearmed = 0;
  std::uint64_t stops = 0;
  std::uint64_t slewed = 0;                      ///< Ticks in which a slew limit was judged,
  std::uint64_t bounded = 0;                     ///< and beyond a soft limit.
  std::array<std::uint64_t, 5> slewed_fields{};  ///< Frames in which the slew of a field was judged,
  std::array<std::uint64_t, 5> softened{};       ///< and its soft start, by TargetTrack::Field.
  std::uint64_t first_angles = 0;                ///< Angles that followed none, with a bound,
  std::uint64_t turns = 0;                       ///< angles at power-up, and
  std::uint64_t zeros = 0;                       ///< answers to requests for a zero that were judged.
  std::uint64_t reduced = 0;                     ///< Frames of motors in reduced mode that were judged,
  std::uint64_t reduced_efforts = 0;             ///< and those of them that tell an effort that is reduced.
  std::uint64_t held_far = 0;         ///< Samples of motors that a loop of rc10d holds, far from where.
  std::uint64_t held_for_nobody = 0;  ///< Ticks of motors that a gimbal held after its client fell silent.
  std::uint64_t homing = 0;           ///< Ticks in which a joint homed,
  std::uint64_t homed = 0;            ///< and homings that found their end.
  std::uint64_t scans = 0;            ///< That began,
  std::uint64_t scanned = 0;          ///< that were made to their end, and
  std::uint64_t scans_refused = 0;
  std::uint64_t questions = 0;  ///< Questions of scans that were judged.
  std::uint64_t stalls = 0;     ///< Buses whose echoes stayed away,
  std::uint64_t probes = 0;     ///< and the rest frames that looked for them, as far as they were read.
  std::uint64_t unread_after_pauses = 0;  ///< Ticks of motors whose feedback was stale by the clock alone.
  std::map<std::string, MotorVisits> motors;  ///< By family, name and robot.
  void add(const Visits& other);
  [[nodiscard]] std::string text() const;
  /// Counters of a run of five minutes that stayed at zero: nothing of theirs was judged.
  [[nodiscard]] std::string idle() const;
  /// Those of an hour: each counter, each mode of each motor or family, each fault that the
  /// chaos provokes.
  [[nodiscard]] std::string idleInAnHour() const;
};

/// "coast"
[[nodiscard]] const char* wordOf(FallbackAction action);
[[nodiscard]] const char* wordOf(Told::Law law);

}  // namespace rc10::test
