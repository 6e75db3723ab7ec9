#pragma once

#include <string>

#include "app/time.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/exchange/events.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// An event in words, from a thread that is not real-time.
[[nodiscard]] inline link::Event noteOf(EventCode code, Severity severity, const std::string& source,
                                        const std::string& text, MonotonicTime now) {
  link::Event note;
  note.utime = wallClockUs();
  note.mono_us = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count();
  note.severity = static_cast<std::uint8_t>(severity);
  note.code = static_cast<std::int32_t>(code);
  note.source = source;
  note.text = text;
  return note;
}

}  // namespace rc10
