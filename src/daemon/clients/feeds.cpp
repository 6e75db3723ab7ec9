#include "daemon/clients/feeds.hpp"

#include "daemon/exchange/clock.hpp"

namespace rc10 {

Feeds::Feeds(const LinkSources& sources, Connections& connections)
    : sources_(sources),
      connections_(connections),
      publication_(sources.robot),
      trace_desk_(sources.robot, sources.exchange.trace) {}

void Feeds::greet(const Connection& connection) const {
  // It carries our version, by which a client of another version can name both.
  auto message = publication_.welcome();
  Connections::send(connection, link::seal(message));
  if (!connection.welcomed || (connection.subscriptions & link::kModules) == 0) return;
  for (std::size_t i = 0; i < sources_.robot.modules.size(); ++i) {
    auto info = publication_.moduleInfo(i);
    Connections::send(connection, link::seal(info));
  }
}

void Feeds::publishState() {
  if (!sources_.exchange.snapshot.everPublished()) return;  // a robot without motors would be a lie
  const auto& snapshot = sources_.exchange.snapshot.read();
  publication_.fill(state_, snapshot, wallClockUs());
  publishEvents();  // first: who reads this state has read what happened before it
  connections_.publish(link::kStates, link::seal(state_));
  if (connections_.wanted(link::kStates)) recordAges(snapshot);
  publishModules(snapshot);
}

bool Feeds::statesWanted() const noexcept { return connections_.wanted(link::kStates | link::kModules); }

void Feeds::recordAges(const Snapshot& snapshot) {
  const auto now = monotonicNow();
  for (std::size_t i = 0; i < snapshot.motor_count; ++i) {
    const auto& motor = snapshot.motors[i];
    if (motor.status != MotorStatus::kOffline && motor.feedback.samples > 0)
      state_ages_.record(now - motor.feedback.received);
  }
}

void Feeds::publishModules(const Snapshot& snapshot) {
  for (std::size_t i = 0; i < snapshot.module_count; ++i) {
    publication_.fill(module_state_, i, snapshot, state_.utime);
    connections_.publish(link::kModules, link::seal(module_state_));
  }
}

void Feeds::publishDiagnostics(const Admission& admission, std::span<const std::string> notices) {
  publication_.fill(diagnostics_, sources_.exchange.snapshot.read(),
                    {.timing = sources_.timing,
                     .ages = sources_.exchange.ages,
                     .state_ages = state_ages_,
                     .late = late_causes_,
                     .inboxes = sources_.inboxes,
                     .admission = admission,
                     .notices = notices,
                     .page_faults = sources_.page_faults ? sources_.page_faults() : 0},
                    wallClockUs());
  connections_.publish(link::kDiagnosticsFeed, link::seal(diagnostics_));
}

void Feeds::publishEvents() {
  Event event;
  while (sources_.exchange.events.pop(event)) tell(publication_.event(event, wallClockUs()));
  link::Event note;
  while (sources_.exchange.notes.pop(note)) tell(note);
  while (sources_.exchange.line_notes.pop(note)) tell(note);
}

void Feeds::tell(link::Event message) {
  connections_.publish(link::kEvents, link::seal(message));
  if (sources_.log) sources_.log(message);
}

void Feeds::chooseTrace(const link::TraceChoice& message, const Connection& connection) {
  publishTrace();  // the last rows of the choice before
  trace_desk_.choose(connection.id, message);
  trace_desk_.fillChoice(trace_);
  Connections::send(connection, link::seal(trace_));
}

void Feeds::publishTrace() {
  while (!trace_desk_.idle() && trace_desk_.fill(trace_)) {
    const auto message = link::seal(trace_);
    for (auto& connection : connections_.all()) {
      if (trace_desk_.isWatching(connection.id)) Connections::sendInOrder(connection, message);
    }
  }
}

void Feeds::countLateTicks() {
  if (sources_.tick_thread.waited)
    late_causes_.update(sources_.timing.late, sources_.timing.duration.count(), sources_.tick_thread);
}

}  // namespace rc10
