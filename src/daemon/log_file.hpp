#pragma once

#include <mutex>
#include <string>
#include <string_view>

#include <spdlog/sinks/base_sink.h>

#include "app/unique_fd.hpp"

namespace rc10 {

/// The end of the log in a file of bounded size, written line by line: it outlives a killed rc10d. A full
/// file becomes <path>.1 and replaces the one before.
class LogFile final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 10U;

  /// The caller is the only one who writes there. Earlier lines come first.
  void keepIn(std::string path);

 private:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}
  void open();
  void write(std::string_view line);

  std::string path_;
  UniqueFd file_;
  std::size_t bytes_ = 0;
  std::string early_;  ///< Lines from before there was a path.
};

}  // namespace rc10
