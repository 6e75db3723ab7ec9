#pragma once

#include <unistd.h>

#include <string>

#include "app/result.hpp"

namespace rc10::link {

/// Folder of sockets and of what others need to know about a running rc10d: $RC10_RUN_DIR, else
/// /run/rc10d. Not for real-time threads.
[[nodiscard]] std::string runDir();

/// Makes the folder if it is missing, and refuses one in which another user could put something in the place
/// of a socket or a lock. `user`: the one who uses it. The error names the remedy.
[[nodiscard]] Result<void> makeRunDir(const std::string& dir, uid_t user = ::geteuid());

/// The link socket of a robot: <runDir>/<robot>.sock.
[[nodiscard]] std::string socketPath(const std::string& robot);

/// The socket for link::EstopDatagram beside a link socket: "<robot>.estop" for "<robot>.sock".
[[nodiscard]] std::string estopPath(const std::string& socket_path);

/// Where rc10d leaves the rest frames of a robot's drives for rc10-stop: <run_dir>/<robot>/rest-frames.
[[nodiscard]] std::string restFramesPath(const std::string& run_dir, const std::string& robot);

/// The end of a robot's log, for rc10-web after rc10d's end: <run_dir>/<robot>.log; what came before is in
/// <run_dir>/<robot>.log.1.
[[nodiscard]] std::string logPath(const std::string& run_dir, const std::string& robot);

/// Reason why rc10d did not start with a file, until it does: <run_dir>/<name of the file>.refusal.
[[nodiscard]] std::string refusalPath(const std::string& run_dir, const std::string& config_file);

/// Where rc10-guard listens: <run_dir>/guard.socket. No robot has a file of this name: its files
/// end in ".sock", ".estop", ".lock" and ".log", and its name has no dot.
[[nodiscard]] std::string guardSocketPath(const std::string& run_dir);

}  // namespace rc10::link
