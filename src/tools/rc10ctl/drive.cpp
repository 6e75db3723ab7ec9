#include "drive.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/printable.hpp"
#include "client/command_stream.hpp"
#include "client/obstacle.hpp"
#include "client/quantity_text.hpp"
#include "client/request_call.hpp"
#include "client/state_text.hpp"
#include "feed.hpp"
#include "link/words.hpp"

namespace rc10::ctl {
namespace {

using std::chrono::steady_clock;

// A lease that is let go ends within a tick or two; one that is not, within its validity.
constexpr Duration kReleasing = std::chrono::milliseconds{2 * kValidityMs};
// States come often enough to show it within this time, though not soon enough to rely on it.
constexpr Duration kLongEnough = std::chrono::milliseconds{200};
constexpr Duration kProgressOnTerminal = std::chrono::milliseconds{100};
constexpr Duration kProgressInFile = std::chrono::milliseconds{500};

class Progress {
 public:
  Progress() : terminal_(::isatty(STDOUT_FILENO) != 0) {}
  ~Progress() { endLine(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Not more often than one can read, but for the last time.
  void show(const std::string& text, bool last) {
    const auto now = steady_clock::now();
    if (now < next_ && !last) return;
    next_ = now + (terminal_ ? kProgressOnTerminal : kProgressInFile);
    std::printf(terminal_ ? "\r%s\x1b[K" : "%s\n", text.c_str());
    std::fflush(stdout);
    line_open_ = terminal_;
  }

  void note(const std::string& text) {
    endLine();
    std::printf("%s\n", text.c_str());
  }

 private:
  void endLine() {
    if (line_open_) std::fputs("\n", stdout);
    line_open_ = false;
  }

  bool terminal_;
  bool line_open_ = false;
  steady_clock::time_point next_{};
};

class Driver {
 public:
  Driver(LinkClient& rc10d, const Drive& order)
      : rc10d_(rc10d),
        order_(order),
        feed_(rc10d),
        name_(order.setpoint.motor.view()),
        setpoint_(order.setpoint),
        stream_({name_}, kSendPeriod) {
    command_.client = kClientName;
    command_.session = randomSession();
    command_.priority = order.priority;
    command_.validity_ms = kValidityMs;
    command_.setpoint_count = 1;
  }

  Driven run() {
    if (const auto there = feed_.awaitState(); !there) return {complain(there.error(), ExitCode::kFailed)};
    if (const auto why = trouble(); !why.empty()) return {complain({why}, ExitCode::kFailed)};
    const std::string why = repeat();
    // It may have been held up in printing, or stopped and ended by a signal.
    if (!over_ && feed_.pump()) {
      hearEvents();
      (void)ended();
    }
    // Best effort, as the setpoint lapses by itself too.
    if (!over_ && order_.then == Then::kCoast) letGo();
    if (!over_ && order_.then == Then::kTimeout && acts()) lapse();
    const bool is_ours = ours(why.empty());
    if (!why.empty()) return {complain({why}, ExitCode::kFailed), is_ours};
    if (order_.then != Then::kDisable)
      std::printf("%s %s\n", name_.c_str(),
                  client::whatActs(motor() != nullptr ? motor()->acting : Acting::kNothing));
    return {ExitCode::kOk, is_ours};
  }

 private:
  // Until the time is over or Ctrl-C. Returns what went wrong, or nothing.
  std::string repeat() {
    Progress progress;
    std::string why = sendOn(progress);
    showNotes(progress);
    return why;
  }

  std::string sendOn(Progress& progress) {
    const auto start = steady_clock::now();
    while (!interrupted()) {
      if (!feed_.pump()) return rc10dEnded().message;
      hearEvents();
      if (auto why = ended(); !why.empty()) return why;
      if (auto why = refused(); !why.empty()) return why;
      const auto now = steady_clock::now();
      if (now - start >= order_.time) break;
      if (stream_.due(now, feed_.state()->mono_us)) {
        sent_before_ = setpoint_.target;
        if (order_.steer) {
          if (const auto end = order_.steer(setpoint_, *feed_.state())) {
            progress.show(line(), true);
            return *end;
          }
        }
        if (!send(setpoint_)) return rc10dEnded().message;
        unheeded_.sent();
        stream_.sent(now);
      }
      // After sending, for a terminal that is held keeps it waiting: what it sends has just been judged.
      showNotes(progress);
      progress.show(line(), false);
      waitReadable(rc10d_, std::min(stream_.next(), start + order_.time) - steady_clock::now());
    }
    progress.show(line(), true);
    // Too short a time to be sure about it otherwise.
    const bool told = !refusal_.empty() || steady_clock::now() - start >= kLongEnough;
    return motor() != nullptr && !interrupted() && !taken_ && told ? whyNotTaken() : std::string{};
  }

  // Reason why its targets are over: nothing may bring the last one back, not even a last message. A motor
  // that was stopped and enabled between two states is known by its events.
  std::string ended() {
    std::string why = trouble();
    if (why.empty()) why = stream_.ended(steady_clock::now());
    over_ = !why.empty();
    return why;
  }

  // Later, what holds the motor is its on_timeout.
  bool acts() const {
    const auto sent = stream_.sentAt();
    return sent && steady_clock::now() - *sent < std::chrono::milliseconds{command_.validity_ms};
  }

  // Coasts, and then gives the motor back: while a target is valid, a coasting one too, nobody else of our
  // priority may move it, not even the next rc10ctl.
  void letGo() {
    auto coast = order_.setpoint;
    coast.target.mode = ControlMode::kCoast;
    if (!send(coast)) return;
    const auto end = steady_clock::now() + kReleasing;
    command_.validity_ms = 1;
    for (auto now = steady_clock::now(); now < end && feed_.pump(); now = steady_clock::now()) {
      if (motor() != nullptr && motor()->mode == ControlMode::kCoast && motor()->owner.view() != kClientName)
        return;
      if (!send(coast)) return;
      waitReadable(rc10d_, std::min<Duration>(kSendPeriod, end - now));
    }
  }

  // The same target, not COAST: rc10d does the motor's on_timeout after a target that lapses, nothing after a
  // COAST. Sent once: a second one would set the target anew.
  void lapse() {
    command_.validity_ms = 1;
    if (!send(setpoint_)) return;
    const auto end = steady_clock::now() + kReleasing;
    for (auto now = steady_clock::now(); now < end && feed_.pump(); now = steady_clock::now()) {
      if (motor() == nullptr || motor()->owner.view() != kClientName) return;
      waitReadable(rc10d_, end - now);
    }
  }

  bool send(const link::Setpoint& setpoint) {
    command_.setpoints[0] = setpoint;
    command_.received_ns = 0;  // the present time
    ++command_.seq;
    return rc10d_.send(command_) != LinkClient::SendStatus::kClosed;
  }

  const link::MotorState* motor() const {
    const auto* state = feed_.state();
    return state != nullptr && order_.motor < state->motor_count ? &state->motors[order_.motor] : nullptr;
  }

  std::string trouble() const {
    return motor() != nullptr ? client::obstacle(*feed_.state(), name_, *motor()) : std::string{};
  }

  // Another rc10ctl has our name.
  bool ours(bool well) const {
    if (motor() == nullptr) return false;
    return motor()->owner.view().empty() ? taken_ || well : inForce();
  }

  // Our target, or the one before it, is that of the motor; another rc10ctl has our name.
  bool inForce() const {
    const auto& now = *motor();
    const auto is = [&now](const Target& target) {
      const bool valued = target.mode != ControlMode::kCoast && target.mode != ControlMode::kBrake;
      return now.mode == target.mode && (!valued || now.target == target.value);
    };
    return now.owner.view() == kClientName && (is(setpoint_.target) || is(sent_before_));
  }

  // Reason why the motor does not do what it is told; empty if it does.
  std::string refused() {
    if (motor() == nullptr) return {};
    if (inForce()) {
      taken_ = true;
      unheeded_.heeded();
      refusal_.clear();
    }
    return unheeded_.tooOften() ? whyNotTaken() : std::string{};
  }

  std::string whyNotTaken() const {
    const std::string why = refusal_.empty() ? std::string{} : " (" + refusal_ + ")";
    const auto owner = motor()->owner.view();
    const std::string asked = std::string(toString(setpoint_.target.mode));
    if (owner == kClientName)
      return "motor '" + name_ + "' obeys another rc10ctl, not this " + asked +
             ": end that one, or take over with a higher --priority";
    if (!owner.empty())
      return "motor '" + name_ + "' is held by " + client::holder(rc10d_.welcome(), owner) +
             ", or take over with a higher --priority";
    return "motor '" + name_ + "' did not take the " + asked + " target" +
           (why.empty() ? ": `rc10ctl stats` shows what was refused" : why);
  }

  void showNotes(Progress& progress) {
    for (const auto& note : std::exchange(notes_, {})) progress.note(note);
  }

  void hearEvents() {
    for (const auto& event : feed_.takeEvents()) {
      if (order_.hear && event.source.view() == name_) order_.hear(event);
      stream_.hear(event);
      // refused() reports it in the end, if the target is not in force by then.
      if (auto why = client::refusalText(event, name_, kClientName); !why.empty()) {
        refusal_ = std::move(why);
        continue;
      }
      const bool concerns_us = event.source.view() == name_ ? event.severity > Severity::kInfo
                                                            : event.severity > Severity::kWarning;
      if (!concerns_us) continue;
      notes_.push_back(std::string(toString(event.severity)) + ": " + printable(event.source.view()) + ": " +
                       printable(event.text.view()));
    }
  }

  std::string line() const {
    if (motor() == nullptr) return name_;
    const auto mode = setpoint_.target.mode;
    std::string text = name_ + "  " + toString(mode);
    if (mode != ControlMode::kCoast && mode != ControlMode::kBrake) {
      text += "  target " + client::quantity(setpoint_.target.value, 2, unitOf(mode));
    }
    text += "  measured " + client::quantity(client::measured(*motor(), mode), 2, client::measuredUnit(mode));
    text += "  current " + client::quantity(static_cast<double>(motor()->current_a), 2, "A");
    const std::string limits = link::limitWords(motor()->limits);
    return limits.empty() ? text : text + "  limit: " + limits;
  }

  LinkClient& rc10d_;
  const Drive& order_;
  Feed feed_;
  std::string name_;
  link::Setpoint setpoint_;         // as steered
  Target sent_before_;              // the one before the last, which the state may still show
  std::string refusal_;             // last refusal by rc10d of a target, in words
  std::vector<std::string> notes_;  // to be shown
  bool taken_ = false;              // has been in force
  bool over_ = false;               // its targets are
  client::CommandStream stream_;
  Unheeded unheeded_;
  link::Command command_;
};

}  // namespace

Driven drive(LinkClient& rc10d, const Drive& order) { return Driver(rc10d, order).run(); }

}  // namespace rc10::ctl
