// rc10d with one more family of motors: the whole program.
#include <iostream>

#include "acme_drive.hpp"
#include "acme_motor.hpp"
#include "config/motor_families.hpp"
#include "daemon/daemon_main.hpp"

// NOLINTNEXTLINE(bugprone-exception-escape): what is left is std::bad_alloc, which is to end the process
int main(int argc, char** argv) {
  if (const auto added = rc10::addMotorFamily({&acme::acmeFamily(), acme::makeAcmeDrive}); !added) {
    std::cerr << added.error().message << '\n';
    return 1;
  }
  return rc10::daemonMain(argc, argv);
}
