#include "daemon/exit_limit.hpp"

#include <cstdlib>
#include <thread>

namespace rc10 {

void limitExit(Duration limit, int status) {
  // Detached: the threads of libraries are waited for after main(), when nothing could wait for this one.
  std::thread{[limit, status] {
    std::this_thread::sleep_for(limit);
    std::_Exit(status);
  }}.detach();
}

}  // namespace rc10
