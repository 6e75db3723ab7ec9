// rc10d with one more type of module: the whole program.
#include <iostream>

#include "config/module_types.hpp"
#include "daemon/daemon_main.hpp"
#include "gripper.hpp"

// NOLINTNEXTLINE(bugprone-exception-escape): what is left is std::bad_alloc, which is to end the process
int main(int argc, char** argv) {
  if (const auto added = rc10::addModuleType(shop::gripperType()); !added) {
    std::cerr << added.error().message << '\n';
    return 1;
  }
  return rc10::daemonMain(argc, argv);
}
