#include "link/process_identity.hpp"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <sstream>

#include "app/whole_file.hpp"

namespace rc10::link {
namespace {

constexpr std::string_view kPid = "# pid ";
constexpr std::string_view kStart = ", start ";

struct ProcessStat {
  char state = '?';
  std::uint64_t start_ticks = 0;
};

// proc(5): the name of the program is the second field, in parentheses, and may have any characters; the
// state is the third field and the start the 22nd.
std::optional<ProcessStat> readStat(pid_t pid) {
  const auto text = readWholeFile("/proc/" + std::to_string(pid) + "/stat");
  if (!text) return std::nullopt;
  const auto name_end = text->rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(text->substr(name_end + 1));
  ProcessStat stat;
  fields >> stat.state;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  return fields >> stat.start_ticks ? std::optional{stat} : std::nullopt;
}

template <typename T>
bool takeNumber(std::string_view& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc{};
}

}  // namespace

ProcessIdentity ProcessIdentity::own() { return of(::getpid()); }

ProcessIdentity ProcessIdentity::of(pid_t pid) {
  const auto stat = readStat(pid);
  return {.pid = pid, .start_ticks = stat ? stat->start_ticks : 0};
}

std::string ProcessIdentity::line() const {
  std::string text{kPid};
  return text.append(std::to_string(pid)).append(kStart).append(std::to_string(start_ticks));
}

std::optional<ProcessIdentity> ProcessIdentity::in(std::string_view text) {
  const auto at = text.substr(0, kPid.size()) == kPid ? 0 : text.find("\n" + std::string(kPid));
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(text.find(kPid, at) + kPid.size());
  ProcessIdentity found;
  if (!takeNumber(text, found.pid) || found.pid <= 0 || text.substr(0, kStart.size()) != kStart)
    return std::nullopt;
  text.remove_prefix(kStart.size());
  return takeNumber(text, found.start_ticks) ? std::optional{found} : std::nullopt;
}

bool ProcessIdentity::runs() const {
  if (::kill(pid, 0) != 0 && errno == ESRCH) return false;
  const auto stat = readStat(pid);
  if (!stat) return true;  // hidden, as under ProtectProc=
  if (stat->state == 'Z' || stat->state == 'X') return false;
  return start_ticks == 0 || stat->start_ticks == start_ticks;
}

}  // namespace rc10::link
