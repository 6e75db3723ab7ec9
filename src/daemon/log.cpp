#include "daemon/log.hpp"

#include <cstdlib>

#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "daemon/exchange/events.hpp"

namespace rc10 {
namespace {

// Lines that wait to be written; older ones are overwritten when the terminal does not keep up.
constexpr std::size_t kQueue = 256;

}  // namespace

std::shared_ptr<spdlog::logger> makeLog() {
  static const auto kPool = std::make_shared<spdlog::details::thread_pool>(kQueue, 1);
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_st>();
  auto log = std::make_shared<spdlog::async_logger>("rc10d", std::move(sink), kPool,
                                                    spdlog::async_overflow_policy::overrun_oldest);
  const bool journal = std::getenv("JOURNAL_STREAM") != nullptr;
  log->set_pattern(journal ? "%v" : "[%H:%M:%S.%e] %^%l%$ %v");
  log->flush_on(spdlog::level::info);
  return log;
}

void logEvent(spdlog::logger& log, const link::Event& event) {
  const auto level = event.severity == Severity::kError     ? spdlog::level::err
                     : event.severity == Severity::kWarning ? spdlog::level::warn
                                                            : spdlog::level::info;
  log.log(level, "{}: {}", event.source.view(), event.text.view());
}

}  // namespace rc10
