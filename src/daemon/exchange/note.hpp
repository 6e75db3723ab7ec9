#pragma once

#include <string_view>

#include "app/time.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/rings.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Events in words, of one code, from a thread that is not real-time to the link thread. Of that thread only.
class Notes {
 public:
  /// The ring of that thread; it outlives this.
  Notes(NoteRing& ring, EventCode code) noexcept : ring_(ring), code_(code) {}

  void tell(std::string_view source, Severity severity, std::string_view text, MonotonicTime now) {
    link::Event note;
    note.utime = wallClockUs();
    note.mono_us = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count();
    note.severity = severity;
    note.code = static_cast<std::int32_t>(code_);
    note.source = source;
    note.text = text;
    // Full: the link thread does not run, and nobody would read it.
    (void)ring_.push(note);
  }

 private:
  NoteRing& ring_;
  EventCode code_;
};

}  // namespace rc10
