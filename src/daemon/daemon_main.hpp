#pragma once

namespace rc10 {

/// The whole of rc10d: command line, configuration, run until a signal. Returns the exit status. A program
/// with families of motors of its own adds them (config/motor_families.hpp) and calls this.
[[nodiscard]] int daemonMain(int argc, char** argv);

}  // namespace rc10
