#include "thread_priorities.hpp"

#include <sched.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "doctor/interrupt_threads.hpp"
#include "doctor/process_list.hpp"

namespace rc10 {
namespace {

constexpr const char* kRightFix =
    ": that needs CAP_SYS_NICE; run it with sudo, or: sudo systemctl enable --now rc10-irq.service";

std::string nameOf(const doctor::PriorityChange& change) {
  return change.interface + ' ' + change.thread.name + " (pid " + std::to_string(change.thread.pid) + ')';
}

}  // namespace

bool ThreadPriorities::concern(const std::vector<CanLinkNews>& news) const {
  return std::any_of(news.begin(), news.end(), [this](const CanLinkNews& link) {
    return link.is_can && link.up &&
           (interfaces_.empty() ||
            std::find(interfaces_.begin(), interfaces_.end(), link.interface) != interfaces_.end());
  });
}

std::vector<std::string> ThreadPriorities::present() const {
  auto present = doctor::canInterfaces(files_);
  if (interfaces_.empty()) return present;
  std::erase_if(present, [this](const std::string& interface) {
    return std::find(interfaces_.begin(), interfaces_.end(), interface) == interfaces_.end();
  });
  return present;
}

Result<bool> ThreadPriorities::apply() const {
  bool changed = false;
  for (const auto& change :
       doctor::priorityChanges(present(), priority_, files_, doctor::readProcesses(files_))) {
    sched_param wanted{};
    wanted.sched_priority = priority_;
    if (::sched_setscheduler(change.thread.pid, SCHED_FIFO, &wanted) != 0) {
      if (errno == ESRCH) continue;  // its interface went down meanwhile
      return fail(nameOf(change) + ": cannot set its priority: " + std::strerror(errno) +
                  (errno == EPERM ? kRightFix : ""));
    }
    changed = true;
    std::printf("%s: priority %s -> %d\n", nameOf(change).c_str(),
                doctor::priorityText(change.thread).c_str(), priority_);
    std::fflush(stdout);
  }
  return changed;
}

void ThreadPriorities::tellMissing() const {
  const auto processes = doctor::readProcesses(files_);
  for (const auto& interface : present()) {
    const auto why = doctor::missingThreads(interface, files_, processes);
    if (!why.empty()) std::printf("%s %s\n", interface.c_str(), why.c_str());
  }
}

}  // namespace rc10
