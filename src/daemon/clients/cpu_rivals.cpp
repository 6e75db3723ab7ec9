#include "daemon/clients/cpu_rivals.hpp"

#include <sched.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace rc10 {
namespace {

// A look at one process takes some 10 us.
constexpr int kProcessesPerWindow = 20;
// Interval of the search for new real-time threads, 2 s.
constexpr int kWindowsPerSearch = 100;

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

/// Word number `field` of proc(5)'s stat, of which the name in parentheses, which may hold anything, is the
/// second.
[[nodiscard]] std::optional<int> wordOf(const std::string& stat, int field) {
  const auto close = stat.rfind(')');
  if (close == std::string::npos) return std::nullopt;
  std::istringstream words(stat.substr(close + 1));
  std::string skipped;
  for (int word = 3; word < field; ++word) words >> skipped;
  int value = 0;
  if (!(words >> value)) return std::nullopt;
  return value;
}

constexpr int kProcessorField = 39;
constexpr int kPriorityField = 40;
constexpr int kPolicyField = 41;

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
    const auto used = usedBy(rival.task / "schedstat");
    rival.before = std::exchange(rival.lately, used && rival.used ? *used - *rival.used : Duration{});
    rival.used = used;
  }
  if (++windows_ > kWindowsPerSearch) forget();
  return windows_ >= 3;
}

std::string CpuRivals::busiest(Duration least) const {
  const auto cpu = wordOf(firstLine(own_stat_), kProcessorField);
  const Rival* most = nullptr;
  for (const auto& rival : rivals_) {
    const Duration used = rival.lately + rival.before;
    if (used < least || (most != nullptr && used <= most->lately + most->before)) continue;
    if (wordOf(firstLine(rival.task / "stat"), kProcessorField) == cpu) most = &rival;
  }
  return most != nullptr ? most->name : std::string{};
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
  if (task.filename() == std::to_string(tid_)) {
    own_stat_ = task / "stat";
    return;
  }
  const std::string stat = firstLine(task / "stat");
  const auto open = stat.find('(');
  const auto close = stat.rfind(')');
  const auto priority = wordOf(stat, kPriorityField);
  const auto policy = wordOf(stat, kPolicyField);
  if (open == std::string::npos || close < open || !priority || !policy) return;
  const bool fixed = *policy == SCHED_FIFO || *policy == SCHED_RR;
  if (*policy == SCHED_DEADLINE || (fixed && *priority >= priority_))
    rivals_.push_back({.task = task, .name = stat.substr(open + 1, close - open - 1)});
}

}  // namespace rc10
