#pragma once

#include <sys/signalfd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

#include "app/result.hpp"
#include "app/spelling.hpp"
#include "app/standard_output.hpp"
#include "app/unique_fd.hpp"

/// Common part of programs that run until a signal ends them.
namespace rc10 {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

/// "poll: Bad address", by errno.
[[nodiscard]] inline std::string systemError(const char* call) {
  return std::string{call} + ": " + std::generic_category().message(errno);
}

/// From here on SIGINT and SIGTERM are only seen as something to read.
[[nodiscard]] inline Result<UniqueFd> makeSignals() {
  sigset_t signals{};
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  if (::sigprocmask(SIG_BLOCK, &signals, nullptr) != 0) return fail(systemError("sigprocmask"));
  UniqueFd fd{::signalfd(-1, &signals, SFD_CLOEXEC)};
  if (!fd) return fail(systemError("signalfd"));
  return fd;
}

/// The exit status, if the command line ends the program: help, version, or a mistake, which was told.
[[nodiscard]] inline std::optional<int> parseCommandLine(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), usageError(app, error, argc, argv).c_str());
    return kExitUsage;
  }
  return std::nullopt;
}

/// For main(): what the program throws, out of memory or a mistake of ours, is told and no crash.
[[nodiscard]] inline int runProgram(const char* name, int (*program)(int, char**), int argc, char** argv) {
  try {
    return statusOfOutput(name, program(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return kExitFailed;
  }
}

}  // namespace rc10
