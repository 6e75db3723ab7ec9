#include "client/command_stream.hpp"

#include <algorithm>
#include <string_view>

#include "app/printable.hpp"
#include "client/obstacle.hpp"

namespace rc10::client {

void CommandStream::hear(const link::Event& event) {
  if (!sent_ || !stopped_.empty()) return;
  const std::string_view source = event.source.view();
  const std::string text = printable(event.text.view());
  if (leavesRun(event)) {
    stopped_ = "the robot: " + text + ": `rc10ctl clear`, then enable its motors";
  } else if (leavesActive(event) && std::find(motors_.begin(), motors_.end(), source) != motors_.end()) {
    stopped_ = "motor '" + printable(source) + "': " + text;
  }
}

bool CommandStream::due(MonotonicTime now, std::int64_t newest_us) noexcept {
  const bool caught_up = catch_up_.done(now, newest_us);
  if (now >= next_ && !caught_up) next_ = now + period_;
  return now >= next_;
}

void CommandStream::sent(MonotonicTime now) noexcept {
  // Those missed in a pause are not made up for; the first one sets the beat.
  next_ = sent_ ? std::max(next_ + period_, now) : now + period_;
  sent_ = now;
}

std::string CommandStream::ended(MonotonicTime now) const {
  if (!stopped_.empty()) return stopped_;
  if (sent_ && now - *sent_ > kLongestPause)
    return "rc10ctl was held up for more than 2 s: its command has ended, and is not sent again";
  return {};
}

}  // namespace rc10::client
