#include "daemon/clients/cpu_rivals.hpp"

#include <sched.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace rc10 {
namespace {

// Some 10 us each.
constexpr int kProcessesPerWindow = 20;

[[nodiscard]] bool isNumber(const std::string& text) noexcept {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

[[nodiscard]] std::string firstLine(const std::filesystem::path& file) {
  std::string line;
  std::getline(std::ifstream(file), line);
  return line;
}

/// Documentation/scheduler/sched-stats.rst: the first number is the time on the CPU, in ns.
[[nodiscard]] std::optional<Duration> usedBy(const std::filesystem::path& schedstat) {
  long long used_ns = 0;
  if (std::sscanf(firstLine(schedstat).c_str(), "%lld", &used_ns) != 1) return std::nullopt;
  return Duration{used_ns};
}

}  // namespace

CpuRivals::CpuRivals(int priority, std::filesystem::path proc)
    : priority_(priority), proc_(std::move(proc)) {}

void CpuRivals::forget() {
  found_ = false;
  windows_ = 0;
  left_.reset();
  rivals_.clear();
}

bool CpuRivals::look() {
  if (!found_) {
    findSome();
    return false;
  }
  for (auto& rival : rivals_) {
    const auto used = usedBy(rival.schedstat);
    rival.before = std::exchange(rival.lately, used && rival.used ? *used - *rival.used : Duration{});
    rival.used = used;
  }
  windows_ = std::min(windows_ + 1, 3);
  return windows_ == 3;
}

std::string CpuRivals::busiest(Duration least) const {
  const auto sum = [](const Rival& rival) { return rival.lately + rival.before; };
  const auto most = std::max_element(rivals_.begin(), rivals_.end(),
                                     [&sum](const Rival& a, const Rival& b) { return sum(a) < sum(b); });
  return most != rivals_.end() && sum(*most) >= least ? most->name : std::string{};
}

void CpuRivals::findSome() {
  std::error_code error;
  if (!left_) left_.emplace(proc_, error);
  const std::filesystem::directory_iterator end;
  for (int i = 0; *left_ != end && i < kProcessesPerWindow; left_->increment(error)) {
    if (error) break;
    if (!isNumber((*left_)->path().filename())) continue;
    ++i;
    std::filesystem::directory_iterator task((*left_)->path() / "task", error);
    for (; !error && task != end; task.increment(error)) take(task->path());
    error.clear();  // it has ended meanwhile
  }
  if (!error && *left_ != end) return;
  left_.reset();
  found_ = true;
}

void CpuRivals::take(const std::filesystem::path& task) {
  if (task.filename() == std::to_string(tid_)) return;
  const std::string stat = firstLine(task / "stat");
  // proc(5): the name in parentheses may hold anything; behind it field 3 and so on, 40 and 41 of which are
  // priority and policy.
  const auto open = stat.find('(');
  const auto close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close < open) return;
  std::istringstream fields(stat.substr(close + 1));
  std::string skipped;
  for (int field = 3; field < 40; ++field) fields >> skipped;
  int priority = 0;
  int policy = 0;
  if (!(fields >> priority >> policy)) return;
  const bool fixed = policy == SCHED_FIFO || policy == SCHED_RR;
  const bool precedes = policy == SCHED_DEADLINE || (fixed && priority >= priority_);
  if (precedes)
    rivals_.push_back({.schedstat = task / "schedstat", .name = stat.substr(open + 1, close - open - 1)});
}

}  // namespace rc10
