#pragma once

#include <memory>
#include <string>

#include <spdlog/logger.h>

#include "link/link_protocol.hpp"

namespace rc10 {

/// The daemon's log: to standard error, written by spdlog's own thread, so that a blocked terminal blocks
/// nobody else. Under systemd the journal adds time and name itself.
/// Never from real-time threads: they report events.
[[nodiscard]] std::shared_ptr<spdlog::logger> makeLog();

/// From now on its end is in this file too, with that of the lines before: see log_file.hpp.
void keepLog(const spdlog::logger& log, const std::string& path);

/// Writes an event as one line, at the level of its severity.
void logEvent(spdlog::logger& log, const link::Event& event);

}  // namespace rc10
