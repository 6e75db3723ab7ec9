#include "robot_client/session/session_options.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>

#include "app/message_limits.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

using std::chrono::milliseconds;

// LCM allows 63 characters for a channel, and ".v1.diagnostics" takes 15 of them.
constexpr std::size_t kMaxRobotName = 48;

[[nodiscard]] bool isChannelName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxRobotName && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
  });
}

}  // namespace

Result<void> checkSession(const std::string& robot, const RobotOptions& options) {
  if (!isChannelName(robot)) {
    return fail("'" + robot + "' is no robot's name: that has letters, digits, '_', '-' and '.', 48 at most");
  }
  if (options.client.size() > kMaxNameBytes) {
    return fail("the client's name '" + options.client + "' is longer than " + std::to_string(kMaxNameBytes) +
                " bytes");
  }
  if (options.validity < milliseconds{1} || options.validity > milliseconds{1000}) {
    return fail("validity is not within 1 to 1000 ms");
  }
  if (options.resend < milliseconds{0} || options.resend >= options.validity) {
    return fail("resend has to be shorter than validity, or the motors coast between two messages");
  }
  if (options.alive_within < milliseconds{0}) return fail("alive_within is negative");
  return {};
}

RobotOptions withClient(RobotOptions options) {
  if (options.client.empty()) {
    options.client = std::string(program_invocation_short_name).substr(0, kMaxNameBytes);
  }
  return options;
}

}  // namespace robot_client
}  // namespace rc10
