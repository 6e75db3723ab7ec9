#include "link/guard_hello.hpp"

#include <sstream>

namespace rc10::link {
namespace {

constexpr std::string_view kProgram = "rc10-guard";
constexpr std::size_t kMaxRobotName = 31;
constexpr std::uint32_t kLongestStandstillMs = 60'000;

bool isRobotName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxRobotName &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string_view::npos;
}

}  // namespace

std::string guardHelloText(const GuardHello& hello) {
  return std::string(kProgram) + ' ' + std::to_string(GuardHello::kVersion) + ' ' + hello.robot + ' ' +
         std::to_string(hello.standstill_ms) + '\n' + hello.rest_frames;
}

Result<GuardHello> parseGuardHello(std::string_view text) {
  const auto line_end = text.find('\n');
  if (line_end == std::string_view::npos) return fail("no hello of rc10d");
  std::istringstream line{std::string(text.substr(0, line_end))};
  std::string program;
  int version = 0;
  GuardHello hello;
  line >> program >> version >> hello.robot >> hello.standstill_ms;
  if (line.fail() || program != kProgram) return fail("no hello of rc10d");
  if (version != GuardHello::kVersion) {
    return fail("rc10d speaks version " + std::to_string(version) + " and rc10-guard version " +
                std::to_string(GuardHello::kVersion) + ": restart rc10-guard");
  }
  if (!isRobotName(hello.robot) || hello.standstill_ms == 0 || hello.standstill_ms > kLongestStandstillMs)
    return fail("the hello of rc10d is malformed");
  hello.rest_frames = text.substr(line_end + 1);
  return hello;
}

}  // namespace rc10::link
