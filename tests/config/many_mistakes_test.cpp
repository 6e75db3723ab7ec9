// A file full of mistakes is mended in one round.

#include <gmock/gmock.h>

#include "config_text.hpp"

namespace rc10::test::many_mistakes_test {
namespace {

const char* const kFullOfMistakes = R"(robot: Hero!
realtime: soft
scheduler: {rate_hz: 3000, priority: 010, cpu: -1, period: 3}
rx: {priority: "65", cpu: 1.5}
lcm: {enabled: yes, url: "udpm://10.0.0.1:7667?ttl=1", state_hz: 1_000}
lcm: {}
profiles:
  wheel: {model: M3508, current_limit_a: 32, curent_limit_a: 5, zero_deg: 5}
buses:
  - name: chassis
    type: can
    interface: can0
    bitrate: 500000
    motors:
      - {name: a, profile: wheel, id: 1}
      - {name: b, profile: wheel, id: 1}
      - {name: a, profile: weel, id: 0x3}
      - {name: c, model: M3509, id: 3}
      - {name: d, model: M3508, id: 9}
      - {name: e, model: M3508, id: 4, command: voltage}
      - {name: f, model: GM6020, id: 5, command: voltage, current_limit_a: 2, velocity_pid: {kp_a_per_rpm: 1}}
      - {name: g, model: M2006, id: 2, gear_ratio: 0, direction: 2, feedback_timeout_ms: 1, optional: True}
      - {model: M2006, id: .5}
      - {name: h, id: 3}
      - name: i
        <<: {a: 1}
        id: !!int 3
        model:
        simulated: {lost_frames: 2, inertia_kg_m2: nan, stalled: 1}
      - [1]
      - {name: j, model: M2006, id: 6, angle_pid: [1, 2], velocity_limit_rpm: 10rpm}
  - name: chassis
    type: sim
    interface: can1
    motors: []
  - {name: third, motors: 5}
moduls: 3
)";

TEST(ManyMistakes, AreAllReportedInOneGoInTheOrderOfTheFile) {
  EXPECT_THAT(
      errorsOf(kFullOfMistakes),
      ::testing::ElementsAre(
          "hero.yaml:1:8: robot: 'Hero!' is not accepted; use 1 to 31 of a-z, 0-9, _ and -",
          "hero.yaml:2:11: realtime: 'soft' is not one of required and preferred; use one of these",
          "hero.yaml:3:22: scheduler.rate_hz: a period of 1/3000 s is no whole number of nanoseconds; use "
          "2560 or 3125",
          "hero.yaml:3:38: scheduler.priority: '010' has a leading zero, which some read as octal; write 10",
          "hero.yaml:3:48: scheduler.cpu: -1 is below 0; use 0 to 1023",
          "hero.yaml:3:52: scheduler.period: unknown key; known here: rate_hz, priority, timer, phase, "
          "phase_clock, overload_ms and cpu",
          "hero.yaml:4:16: rx.priority: '65' is a text because of its quotes; remove them",
          "hero.yaml:4:27: rx.cpu: '1.5' is not a whole number; remove the fraction",
          "hero.yaml:5:16: lcm.enabled: 'yes' is not true or false; write one of these",
          "hero.yaml:5:26: lcm.url: the address '10.0.0.1' is not valid; use a multicast group, 224.0.0.0 to "
          "239.255.255.255",
          "hero.yaml:5:66: lcm.state_hz: '1_000' has an underscore; write 1000",
          "hero.yaml:6:1: lcm: given twice, first at 5:1; keep one",
          "hero.yaml:8:42: profiles.wheel.current_limit_a: 32 is above the M3508 limit of 20; use more than "
          "0, at most "
          "20",
          "hero.yaml:8:46: profiles.wheel.curent_limit_a: unknown key; did you mean current_limit_a?",
          "hero.yaml:8:75: profiles.wheel.zero_deg: the M3508 does not know its output angle at power-up; "
          "use zero: "
          "power_on",
          "hero.yaml:11:11: buses[0].type: 'can' is not one of socketcan and sim; use one of these",
          "hero.yaml:13:14: buses[0].bitrate: DJI drives speak 1000000 bit/s only; use 1000000",
          "hero.yaml:16:39: buses[0].motors[1].id: 'a' (M3508 id 1) and 'b' (M3508 id 1) both answer with "
          "0x201; give "
          "each its own: free for M3508: 3, 4, 5, 7 and 8",
          "hero.yaml:17:16: buses[0].motors[2].name: motor name 'a' is taken by buses[0].motors[0].name "
          "(line 15); it "
          "must be unique in the robot, over all buses",
          "hero.yaml:17:28: buses[0].motors[2].profile: 'weel' is not one of wheel; did you mean wheel?",
          "hero.yaml:17:38: buses[0].motors[2].id: '0x3' is not decimal; write 3",
          ::testing::AllOf(::testing::StartsWith(
                               "hero.yaml:18:26: buses[0].motors[3].model: 'M3509' is not one of M3508, "),
                           ::testing::EndsWith("; did you mean M3508?")),
          "hero.yaml:19:37: buses[0].motors[4].id: 9 is above the highest M3508 id 8; use 1 to 8",
          "hero.yaml:20:49: buses[0].motors[5].command: the M3508 obeys currents only; remove it, or write "
          "command: "
          "current",
          "hero.yaml:21:76: buses[0].motors[6].current_limit_a: with command: voltage the GM6020 is "
          "commanded in volts; use voltage_limit_v",
          "hero.yaml:21:108: buses[0].motors[6].velocity_pid.kp_a_per_rpm: with command: voltage the GM6020 "
          "is commanded in volts; use kp_v_per_rpm",
          "hero.yaml:22:52: buses[0].motors[7].gear_ratio: 0 is not accepted; use more than 0, at most 10000",
          "hero.yaml:22:66: buses[0].motors[7].direction: '2' is not one of 1 and -1; use one of these",
          "hero.yaml:22:90: buses[0].motors[7].feedback_timeout_ms: 1 is below 2 ms; use 2 to 1000 ms",
          "hero.yaml:22:103: buses[0].motors[7].optional: 'True' is not true or false; write one of these",
          "hero.yaml:23:9: buses[0].motors[8].name: is missing; add it: Name of the motor in commands and "
          "states, "
          "unique in the robot.",
          "hero.yaml:23:28: buses[0].motors[8].id: '.5' begins with a point; write 0.5",
          "hero.yaml:24:9: buses[0].motors[9].model: is missing; add it here or in a profile",
          "hero.yaml:26:9: buses[0].motors[10].<<: merge keys are not accepted; use a profile, or write the "
          "keys out",
          "hero.yaml:27:13: buses[0].motors[10].id: tags are not accepted; remove the '!...' before the "
          "value",
          ::testing::StartsWith("hero.yaml:28:9: buses[0].motors[10].model: is empty; write M3508, M2006, "),
          "hero.yaml:29:34: buses[0].motors[10].simulated.lost_frames: 2 is above 1; use 0 to 1",
          "hero.yaml:29:52: buses[0].motors[10].simulated.inertia_kg_m2: 'nan' is not finite; write a number",
          "hero.yaml:29:66: buses[0].motors[10].simulated.stalled: '1' is not true or false; write one of "
          "these",
          "hero.yaml:30:9: buses[0].motors[11]: is a list; write a map of keys",
          "hero.yaml:31:51: buses[0].motors[12].angle_pid: is a list; write a map of keys",
          "hero.yaml:31:79: buses[0].motors[12].velocity_limit_rpm: '10rpm' has something after the number; "
          "write 10: "
          "the unit is in the key's name",
          "hero.yaml:32:11: buses[1].name: bus name 'chassis' is taken by buses[0].name (line 10); it must "
          "be unique in "
          "the robot",
          "hero.yaml:34:16: buses[1].interface: a simulated bus has no interface; remove it",
          "hero.yaml:35:13: buses[1].motors: has 0 entries; use 1 to 32",
          "hero.yaml:36:5: buses[2].interface: is missing; add the CAN interface (interface: can0), or write "
          "type: sim",
          "hero.yaml:36:27: buses[2].motors: is a single value; write a list, each item a map of keys",
          "hero.yaml:37:1: moduls: unknown key; did you mean modules?"));
}

TEST(ManyMistakes, LeaveNoConfiguration) {
  const auto outcome = parseRobotConfig(kFullOfMistakes, "hero.yaml");
  EXPECT_FALSE(outcome);
  EXPECT_FALSE(outcome.config.has_value());
}

TEST(ManyMistakes, BeyondAnyReasonAreCutOff) {
  std::string text = "robot: hero\n";
  for (int i = 0; i < 5000; ++i) text += "key" + std::to_string(i) + ": 1\n";
  const auto errors = errorsOf(text);
  EXPECT_EQ(errors.size(), Problems::kMost + 1);
  EXPECT_EQ(errors.back(), "hero.yaml: more problems than can be listed; mend these first");
}

}  // namespace
}  // namespace rc10::test::many_mistakes_test
