#include "app/standard_output.hpp"
#include "daemon/daemon_main.hpp"

// NOLINTNEXTLINE(bugprone-exception-escape): what is left is std::bad_alloc, which is to end the process
int main(int argc, char** argv) { return rc10::statusOfOutput("rc10d", rc10::daemonMain(argc, argv)); }
