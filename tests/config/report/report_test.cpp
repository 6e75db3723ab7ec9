#include "config/report/report.hpp"

#include <sstream>

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::report_test {
namespace {

using ::testing::HasSubstr;

const char* const kRobot = R"(robot: hero
realtime: preferred
scheduler: {priority: 50, cpu: 3}
lcm: {state_hz: 100}
buses:
  - name: chassis
    type: sim
    sim: {seed: 9}
    motors:
      - {name: left, model: M3508, id: 1, current_limit_a: 10, zero: power_on}
      - {name: right, model: M3508, id: 2, direction: -1, optional: true, velocity_pid: {type: incremental}}
  - name: gimbal
    interface: can1
    motors:
      - {name: yaw, model: GM6020, id: 5, command: voltage, voltage_limit_v: 12, zero_deg: 123.4}
)";

std::string report() { return describe(parseRobotConfig(kRobot, "hero.yaml").config.value()); }

/// The words of the line that begins with this one.
std::vector<std::string> wordsAfter(const std::string& text, const std::string& first, int occurrence = 0) {
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line};
    std::vector<std::string> all;
    for (std::string word; words >> word;) all.push_back(word);
    if (!all.empty() && all.front() == first && occurrence-- == 0) return {all.begin() + 1, all.end()};
  }
  return {};
}

TEST(Report, SaysHowTheRobotRuns) {
  EXPECT_THAT(report(), HasSubstr("robot      hero (hero.yaml)\n"
                                  "realtime   preferred\n"
                                  "guard      preferred\n"
                                  "scheduler  1000 Hz, SCHED_FIFO 50, CPU 3\n"
                                  "receive    by the tick\n"
                                  "lcm        udpm://239.255.76.67:7667?ttl=0, state at 100 Hz\n"));
}

TEST(Report, NamesTheThreadOfSerialPortsWhereThereAreSome) {
  const std::string imu = "modules: [{name: imu, type: imu, protocol: hipnuc, port: /dev/ttyUSB0}]\n";
  const auto loaded = parseRobotConfig(kRobot + imu, "hero.yaml");
  ASSERT_TRUE(loaded.config) << loaded.errorText();
  EXPECT_THAT(describe(*loaded.config), HasSubstr("by the tick; serial ports SCHED_FIFO 65, any CPU\n"));
}

TEST(Report, RoundsNumbers) {
  const std::string robot =
      "robot: hero\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
      "      - {name: arm, model: DM4310, id: 3, master_id: 19, command_divider: 3}\n"
      "      - {name: wheel, model: M3508, id: 1, velocity_pid: {kp_a_per_rpm: 0.333333333}}\n";
  const auto text = describe(parseRobotConfig(robot, "hero.yaml").config.value());
  EXPECT_THAT(text, HasSubstr("0x003 at 333.3 Hz "));
  EXPECT_THAT(text, HasSubstr("position, kp 0.333333, ki 1.6, kd 0 "));
}

TEST(Report, SaysWhichInterfacesItSetsUp) {
  auto config = parseRobotConfig(kRobot, "hero.yaml").config.value();
  EXPECT_THAT(describe(config), ::testing::Not(HasSubstr("set up by rc10d")));
  config.buses[1].manage_link = true;
  EXPECT_THAT(describe(config), HasSubstr("bus gimbal: SocketCAN on can1 (set up by rc10d), 1000000 bit/s"));
}

TEST(Report, PredictsTheLoadOfEachBus) {
  EXPECT_THAT(report(),
              HasSubstr("bus chassis: simulated, seed 9, 1000000 bit/s, predicted load 33.3 % to 40.5 % (no "
                        "stuff bits, all stuff bits)\n"));
  EXPECT_THAT(report(),
              HasSubstr("bus gimbal: SocketCAN on can1, 1000000 bit/s, predicted load 22.2 % to 27 % (no "
                        "stuff bits, all stuff bits)\n"));
}

TEST(Report, ShowsIdsAndSlotsOfEachMotor) {
  EXPECT_THAT(wordsAfter(report(), "left"),
              ::testing::ElementsAre("M3508", "1", "0x201", "at", "1000", "Hz", "0x200", "slot", "1", "27",
                                     "%", "normal", "19.2032", "at", "power-on", "20", "ms"));
  EXPECT_THAT(wordsAfter(report(), "right"),
              ::testing::ElementsAre("(optional)", "M3508", "2", "0x202", "at", "1000", "Hz", "0x200", "slot",
                                     "2", "13.5", "%", "reversed", "19.2032", "on", "request", "20", "ms"));
  EXPECT_THAT(wordsAfter(report(), "yaw"),
              ::testing::ElementsAre("GM6020", "5", "0x209", "at", "1000", "Hz", "0x2FF", "slot", "1", "27",
                                     "%", "normal", "1", "at", "123.4", "deg", "20", "ms"));
}

TEST(Report, ShowsLimitsAndLoopsOfEachMotor) {
  EXPECT_THAT(wordsAfter(report(), "left", 1), ::testing::Contains("10"));
  EXPECT_THAT(wordsAfter(report(), "left", 1), ::testing::Contains("position,"));
  EXPECT_THAT(wordsAfter(report(), "right", 1), ::testing::Contains("incremental,"));
  EXPECT_THAT(wordsAfter(report(), "yaw", 1), ::testing::Contains("V"));
}

TEST(Report, ShowsTheGainsThatActBehindAGear) {
  const auto text =
      describe(parseRobotConfig(robotWith("{name: bare, model: M3508, id: 1, gear_ratio: 1}"), "hero.yaml")
                   .config.value());
  EXPECT_THAT(text, HasSubstr("9217.54 rpm  position, kp 0.0104149, ki 0.0833194, kd 0  "
                              "kp 4, ki 0, kd 0, up to 3840.64 rpm"));
}

TEST(Report, NamesNoVelocityLoopThatTheDriveClosesItself) {
  const auto text =
      describe(parseRobotConfig(robotWith("{name: wheel, model: VESC, id: 1, pole_pairs: 7}"), "hero.yaml")
                   .config.value());
  EXPECT_THAT(text, HasSubstr("its own   its own        kp 1.5, ki 0, kd 0\n"));
}

TEST(Report, ListsTheModesTheMotorsTake) {
  EXPECT_THAT(report(), HasSubstr("modes of all: coast, current, velocity, angle, total_angle, brake\n"));
  EXPECT_THAT(report(), HasSubstr("modes of all: coast, velocity, angle, total_angle, voltage, brake\n"));
}

TEST(Report, NamesTheMissingWatchdog) {
  EXPECT_THAT(report(), HasSubstr("DJI drives have no command watchdog"));
}

TEST(Report, IsPlainAsciiWithoutBlanksAtLineEnds) {
  for (const char c : report()) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~'));
  EXPECT_EQ(report().find(" \n"), std::string::npos);
}

TEST(Report, AlignsItsColumns) {
  std::istringstream lines{report()};
  std::vector<std::size_t> columns;
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find("slot ");
    if (at != std::string::npos && line.find("0x200") != std::string::npos) columns.push_back(at);
  }
  ASSERT_EQ(columns.size(), 2U);
  EXPECT_EQ(columns[0], columns[1]);
}

TEST(Report, SaysWhatAMotorDoesWhenNobodyCommandsIt) {
  const std::string robot =
      "robot: hero\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
      "      - {name: arm, model: M2006, id: 1, on_timeout: hold, on_disable: damp, "
      "on_estop: brake, angle_max_deg: 90}\n"
      "      - {name: wheel, model: M3508, id: 2}\n"
      "groups: [{name: lift, motors: [arm, wheel], on_return: rearm_at_rest, together: true}]\n";
  const auto text = describe(parseRobotConfig(robot, "hero.yaml").config.value());
  EXPECT_THAT(wordsAfter(text, "arm", 2),
              ::testing::ElementsAre("hold", "damp", "brake,", "after", "10", "s", "damp", "750", "rpm",
                                     "any", "to", "90", "deg"));
  EXPECT_THAT(wordsAfter(text, "wheel", 2),
              ::testing::ElementsAre("coast", "coast", "coast", "723", "rpm", "none"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "group lift: arm and wheel are enabled and stop together, and are enabled again by themselves "
          "at rest\n"));
}

TEST(Report, SaysWhichGroupsModulesImplyAndWhoIsSpared) {
  const std::string wheels =
      "robot: hero\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
      "      - {name: up, model: M3508, id: 1}\n"
      "      - {name: down, model: M3508, id: 2}\n"
      "      - {name: left, model: M3508, id: 3}\n"
      "      - {name: right, model: M3508, id: 4, optional: true}\n"
      "      - {name: rear, model: M3508, id: 5, optional: true}\n"
      "      - {name: front, model: M3508, id: 6}\n";
  const auto described = [&](const std::string& more) {
    const auto outcome = parseRobotConfig(wheels + more, "hero.yaml");
    EXPECT_TRUE(outcome) << outcome.errorText();
    return outcome.config ? describe(*outcome.config) : std::string{};
  };
  const std::string pair =
      "modules:\n  - {name: lift, type: synchronised_pair, left: up, right: down, velocity_limit_rpm: 100}\n";
  const std::string chassis =
      "  - {name: base, type: differential_chassis, wheel_radius_m: 0.1, track_m: 0.4, max_speed_m_s: 1, "
      "max_turn_deg_s: 90, max_acceleration_m_s2: 1, max_turn_acceleration_deg_s2: 90, "
      "wheels: {left: left, right: right}}\n";
  const auto implied = described(pair + chassis);
  EXPECT_THAT(implied,
              HasSubstr("\ngroup lift (of its module): up and down are enabled and stop together, and "
                        "are enabled again by themselves at rest\n"));
  EXPECT_THAT(implied,
              HasSubstr("\ngroup base (of its module): left and right stop together, and are enabled "
                        "again by themselves at rest; nothing stops or waits for right, which is "
                        "optional\n"));
  const auto declared = described("groups: [{name: all, motors: [front, right, rear, left]}]\n" + pair);
  EXPECT_THAT(declared,
              HasSubstr("\ngroup all: front, right, rear and left stop together, and are enabled again "
                        "by request; nothing stops or waits for right and rear, which are "
                        "optional\n"));
}

}  // namespace
}  // namespace rc10::test::report_test
