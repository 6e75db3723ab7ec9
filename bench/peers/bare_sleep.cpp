// A loop of 1 kHz that does nothing but sleep to its grid, SCHED_FIFO 60 as rc10d's scheduler: how late a
// thread of its priority wakes on this computer. Until SIGTERM; prints the percentiles as a JSON object.
#include <sys/mman.h>

#include <cstdio>

#include "grid.hpp"

namespace {

// Phase: where rc10d's ticks lie.
constexpr std::int64_t kPhase_ns = rc10::peers::kMs_ns * 3 / 10;

}  // namespace

int main() {
  using namespace rc10::peers;
  schedule(SCHED_FIFO, kPriority);
  Grid grid((now_ns() / kMs_ns + 1) * kMs_ns + kPhase_ns);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::perror("bare_sleep");
    return 1;
  }
  while (grid.sleep()) {
  }
  grid.printLateness();
}
