// The configuration file as a document, before any key is looked at.

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

#include "config/config_text.hpp"
#include "config/yaml/source_text.hpp"
#include "config/yaml/yaml_reader.hpp"

namespace rc10::test::yaml_document_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content)
      : path_(std::filesystem::temp_directory_path() /
              ("rc10_config_" + std::to_string(getpid()) + ".yaml")) {
    std::ofstream{path_, std::ios::binary} << content;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path_); }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(YamlDocument, IsAcceptedWithWindowsLineEndsAndByteOrderMark) {
  std::string text = "\xEF\xBB\xBF" + robotAfter("robot: hero\n");
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  EXPECT_THAT(errorsOf(text), IsEmpty());
}

TEST(YamlDocument, MayBeJson) {
  EXPECT_THAT(errorsOf(R"({"robot": "hero", "buses": [{"name": "a", "type": "sim",
      "motors": [{"name": "b", "model": "M2006", "id": 1}]}]})"),
              IsEmpty());
}

TEST(YamlDocument, SaysWhereTheSyntaxBreaks) {
  EXPECT_THAT(errorsOf("robot: hero\n\tlcm: 3\n"),
              ElementsAre("hero.yaml:2:1: not YAML: a tab in front of this line; indent with spaces"));
  EXPECT_THAT(errorsOf("robot: hero\nbuses:\n\t- name: chassis\n"),
              ElementsAre("hero.yaml:3:2: not YAML: a tab in front of this line; indent with spaces"));
  EXPECT_THAT(errorsOf("robot: hero\n buses: []\n"),
              ElementsAre("hero.yaml:2:7: not YAML: illegal map value; look here and at the line above for a "
                          "missing colon, quote, bracket or space"));
}

TEST(YamlDocument, MustNotBeEmpty) {
  const auto* reason = "hero.yaml: the document is empty; a robot needs at least 'robot' and 'buses'";
  for (const auto* text : {"", "\n\n", "# only a comment\n", "---\n", "~\n", "---\n...\n"}) {
    EXPECT_THAT(errorsOf(text), ElementsAre(reason)) << text;
  }
}

TEST(YamlDocument, MustBeAMap) {
  EXPECT_THAT(errorsOf("hero\n"), ElementsAre("hero.yaml:1:1: is a single value; write a map of keys"));
  EXPECT_THAT(errorsOf("- hero\n"), ElementsAre("hero.yaml:1:1: is a list; write a map of keys"));
}

TEST(YamlDocument, MustBeTheOnlyOneInItsFile) {
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\n") + "---\nrobot: other\n"),
              ElementsAre("hero.yaml:4:1: a second document begins here; keep one robot in a file"));
}

TEST(YamlDocument, RefusesAKeyGivenTwiceAtAnyLevel) {
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nrobot: heroine\n")),
              ElementsAre("hero.yaml:2:1: robot: given twice, first at 1:1; keep one"));
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: M3508, id: 1, \"id\": 2}")),
              ElementsAre("hero.yaml:6:40: buses[0].motors[0].id: given twice, first at 6:33; keep one"));
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, velocity_pid: {deadband_rpm: 1, deadband_rpm: 1}}")),
      ElementsAre("hero.yaml:6:72: buses[0].motors[0].velocity_pid.deadband_rpm: given twice, first at "
                  "6:55; keep one"));
}

TEST(YamlDocument, RefusesMergeKeysTagsAndKeysThatAreNoNames) {
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nlcm: &l {state_hz: 100}\nrx:\n  <<: *l\n")),
      ElementsAre("hero.yaml:4:3: rx.<<: merge keys are not accepted; use a profile, or write the keys out"));
  EXPECT_THAT(errorsOf(robotAfter("robot: !!str hero\n")),
              ElementsAre("hero.yaml:1:8: robot: tags are not accepted; remove the '!...' before the value"));
  EXPECT_THAT(errorsOf(robotAfter("robot: !mine hero\n")),
              ElementsAre("hero.yaml:1:8: robot: tags are not accepted; remove the '!...' before the value"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nlcm: !map {}\n")),
              ElementsAre("hero.yaml:2:6: lcm: tags are not accepted; remove the '!...' before the value"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\n? [a, b]\n: 3\n")),
              ElementsAre("hero.yaml:2:3: a key is a list; write a name before the colon"));
}

TEST(YamlDocument, AcceptsAnchorsAndAliases) {
  const auto outcome = parseRobotConfig(
      "robot: hero\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
      "      - {name: left, model: M3508, id: 1, velocity_pid: &gains {kp_a_per_rpm: 0.5}}\n"
      "      - {name: right, model: M3508, id: 2, velocity_pid: *gains}\n",
      "hero.yaml");
  ASSERT_TRUE(outcome) << outcome.errorText();
  const auto& loop = outcome.config->buses[0].motors[1].settings.loops.velocity;
  EXPECT_EQ(std::get<PID_Position::Config>(loop).kp, 0.5F);
}

TEST(YamlDocument, ReportsAMistakeBehindAnAnchorOnce) {
  EXPECT_THAT(errorsOf("robot: hero\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
                       "      - {name: left, model: M3508, id: 1, velocity_pid: &gains {kp_a_per_rpm: 010}}\n"
                       "      - {name: right, model: M3508, id: 2, velocity_pid: *gains}\n"),
              ElementsAre("hero.yaml:6:79: buses[0].motors[0].velocity_pid.kp_a_per_rpm: '010' has a leading "
                          "zero, which some read as octal; write 10"));
}

TEST(YamlDocument, RefusesAliasesThatMultiplyBeyondTheLimit) {
  std::string laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const auto alias = "*a" + std::to_string(i - 1);
    laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + repeated(alias + ", ", 9) +
              alias + "]\n";
  }
  EXPECT_THAT(errorsOf(laughs),
              ElementsAre("hero.yaml:5:10: more than 20000 values, an alias counted as all it "
                          "stands for; this is no configuration"));
}

TEST(YamlDocument, RefusesAnAliasInsideItsOwnAnchor) {
  EXPECT_THAT(errorsOf("robot: &r [*r]\n"),
              ElementsAre("hero.yaml:1:12: this alias stands inside its own anchor; write the value out"));
}

TEST(YamlDocument, RefusesNestingBeyondTheLimitHoweverItIsWritten) {
  const auto reason = "nested more than 16 deep; a configuration needs 6";
  EXPECT_THAT(errorsOf("a: " + repeated("[", 16) + repeated("]", 16)),
              ElementsAre("hero.yaml:1:19: " + std::string{reason}));
  // Brackets that are never closed might begin keys, so yaml-cpp counts them twice.
  EXPECT_THAT(errorsOf("a: " + repeated("[", 100'000)),
              ElementsAre("hero.yaml:1:12: " + std::string{reason}));
  EXPECT_THAT(errorsOf("a: " + repeated("{a: ", 1000)),
              ElementsAre("hero.yaml:1:64: " + std::string{reason}));
  EXPECT_THAT(errorsOf(repeated("- ", 100'000)), ElementsAre("hero.yaml:1:33: " + std::string{reason}));
}

TEST(YamlDocument, RefusesALongText) {
  EXPECT_THAT(errorsOf("robot: " + std::string(1025, 'a') + "\n"),
              ElementsAre("hero.yaml:1:8: a text of 1025 bytes; at most 1024 are accepted"));
}

TEST(YamlDocument, RefusesMoreThanOneMebibyte) {
  EXPECT_THAT(errorsOf(std::string(kMaxConfigBytes + 1, '#')),
              ElementsAre("hero.yaml: larger than 1024 KiB; this is no configuration"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\n" + repeated("# filler\n", 100'000))), IsEmpty());
}

TEST(YamlDocument, RefusesBytesThatAreNotUtf8) {
  const auto reason = [](const std::string& place) {
    return "hero.yaml:" + place + ": this byte is not UTF-8; save the file as UTF-8";
  };
  EXPECT_THAT(errorsOf("robot: hero\n# \xC3\xA9t\xE9\n"), ElementsAre(reason("2:5")));
  for (const auto* text : {"\xFF\xFE", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF8",
                           "\xE2\x82", "\x80"}) {
    EXPECT_THAT(errorsOf(text), ElementsAre(reason("1:1")));
  }
  EXPECT_THAT(errorsOf(robotAfter("# \xE7\x94\xB5\xE6\x9C\xBA \xF0\x9F\xA4\x96\nrobot: hero\n")), IsEmpty());
}

TEST(YamlDocument, RefusesControlCharacters) {
  EXPECT_THAT(errorsOf(std::string_view{"robot: a\0b\n", 11}),
              ElementsAre("hero.yaml:1:9: a control character; remove it"));
  EXPECT_THAT(errorsOf("robot: hero\n# \x1B[31m\n"),
              ElementsAre("hero.yaml:2:3: a control character; remove it"));
  EXPECT_THAT(errorsOf("robot: hero\rlcm: {}\n"),
              ElementsAre("hero.yaml:1:12: a control character; remove it"));
}

TEST(YamlDocument, ShowsTextFromTheFileWithoutControlCharacters) {
  EXPECT_THAT(
      errorsOf(robotAfter("robot: \"\\e[31m\\x9b\xE7\x94\xB5\"\n")),
      ElementsAre(
          "hero.yaml:1:8: robot: '?[31m?\xE7\x94\xB5' is not accepted; use 1 to 31 of a-z, 0-9, _ and -"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\n\"\\e]0;x\\a\": 1\n")),
              Contains(::testing::StartsWith("hero.yaml:2:1: ?]0;x?: unknown key")));
}

TEST(YamlDocument, SaysWhyAFileCannotBeRead) {
  EXPECT_EQ(loadRobotConfig("/nonexistent/hero.yaml").errorText(),
            "/nonexistent/hero.yaml: cannot be read: No such file or directory\n");
  const auto folder = std::filesystem::temp_directory_path().string();
  EXPECT_EQ(loadRobotConfig(folder).errorText(), folder + ": is a directory; give a YAML file\n");
}

TEST(YamlDocument, IsReadFromAFile) {
  const TemporaryFile file{robotAfter("robot: hero\n")};
  const auto outcome = loadRobotConfig(file.path());
  ASSERT_TRUE(outcome) << outcome.errorText();
  EXPECT_EQ(outcome.config->robot, "hero");
  EXPECT_EQ(outcome.config->file, file.path());
}

TEST(YamlDocument, LargerThanTheLimitIsNotReadWhole) {
  const TemporaryFile file{std::string(3 * kMaxConfigBytes, ' ')};
  EXPECT_EQ(loadRobotConfig(file.path()).errorText(),
            file.path() + ": larger than 1024 KiB; this is no configuration\n");
}

TEST(YamlDocument, TellsErrorsAndWarningsInTheOrderOfTheFile) {
  const auto outcome = parseRobotConfig(
      "robot: hero\n"
      "buses:\n"
      "  - name: a\n"
      "    type: sim\n"
      "    motors:\n"
      "      - {name: fast, model: M3508, id: 1, velocity_limit_rpm: 600}\n"
      "      - {name: wrong, model: M3509, id: 2}\n",
      "hero.yaml");
  const auto text = outcome.text();
  EXPECT_THAT(text, ::testing::StartsWith("hero.yaml:6:"));
  EXPECT_THAT(text, ::testing::HasSubstr(": warning: buses[0].motors[0].velocity_limit_rpm: "));
  EXPECT_THAT(text, ::testing::HasSubstr("\nhero.yaml:7:"));
  EXPECT_THAT(text.substr(text.find('\n')), ::testing::Not(::testing::HasSubstr("warning")));
}

}  // namespace
}  // namespace rc10::test::yaml_document_test
