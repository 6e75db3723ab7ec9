#include "daemon/log.hpp"

#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>

#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/ansicolor_sink.h>

#include "app/printable.hpp"
#include "app/stderr_lines.hpp"
#include "app/unique_fd.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/log_file.hpp"

namespace rc10 {
namespace {

// Lines that wait to be written; older ones are overwritten when the terminal does not keep up.
constexpr std::size_t kQueue = 256;

// Lines have names and texts of clients in them, which must not act on a terminal or look like other lines.
class PrintableText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
              spdlog::memory_buf_t& line) override {
    const std::string text = printable({message.payload.data(), message.payload.size()});
    line.append(text.data(), text.data() + text.size());
  }
  [[nodiscard]] std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableText>();
  }
};

using ColorSink = spdlog::sinks::ansicolor_sink<spdlog::details::console_nullmutex>;

// Open for as long as the process lives, as stderr is.
std::FILE* unblockedStderr() {
  UniqueFd terminal = unblockedTerminal(STDERR_FILENO);
  std::FILE* const file = terminal ? ::fdopen(terminal.get(), "w") : nullptr;
  if (file == nullptr) return stderr;
  (void)terminal.release();
  return file;
}

// A stderr without a reader (full pipe, hung terminal) holds up neither the log nor the end of rc10d: it is
// waited for once, then its lines are dropped until it takes some again.
class UnblockedStderr final : public ColorSink {
 public:
  UnblockedStderr() : ColorSink(unblockedStderr(), spdlog::color_mode::automatic) {}

  void log(const spdlog::details::log_msg& message) override {
    pollfd stderr_takes{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
    taken_ = ::poll(&stderr_takes, 1, taken_ ? kPatienceMs : 0) > 0;
    if (taken_) ColorSink::log(message);
  }

 private:
  static constexpr int kPatienceMs = 2000;

  bool taken_ = true;
};

}  // namespace

std::shared_ptr<spdlog::logger> makeLog() {
  static const auto kPool = std::make_shared<spdlog::details::thread_pool>(kQueue, 1);
  auto file = std::make_shared<LogFile>();
  auto log = std::make_shared<spdlog::async_logger>(
      "rc10d", spdlog::sinks_init_list{std::make_shared<UnblockedStderr>(), file}, kPool,
      spdlog::async_overflow_policy::overrun_oldest);
  const bool journal = std::getenv("JOURNAL_STREAM") != nullptr;
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableText>('*').set_pattern(journal ? "%*" : "[%H:%M:%S.%e] %^%l%$ %*");
  log->set_formatter(std::move(formatter));
  auto dated = std::make_unique<spdlog::pattern_formatter>();
  dated->add_flag<PrintableText>('*').set_pattern("%Y-%m-%d %H:%M:%S.%e %l %*");
  file->set_formatter(std::move(dated));
  log->flush_on(spdlog::level::info);
  return log;
}

void keepLog(const spdlog::logger& log, const std::string& path) {
  for (const auto& sink : log.sinks()) {
    if (auto* file = dynamic_cast<LogFile*>(sink.get())) file->keepIn(path);
  }
}

void logEvent(spdlog::logger& log, const link::Event& event) {
  const auto level = event.severity == Severity::kError     ? spdlog::level::err
                     : event.severity == Severity::kWarning ? spdlog::level::warn
                                                            : spdlog::level::info;
  log.log(level, "{}: {}", event.source.view(), event.text.view());
}

}  // namespace rc10
