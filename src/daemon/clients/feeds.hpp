#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "daemon/clients/admission.hpp"
#include "daemon/clients/connections.hpp"
#include "daemon/clients/late_tick_causes.hpp"
#include "daemon/clients/link_sources.hpp"
#include "daemon/clients/publication.hpp"
#include "daemon/clients/trace_desk.hpp"
#include "daemon/exchange/histogram.hpp"
#include "link/link_message.hpp"

namespace rc10 {

/// Fills in what clients subscribe to, and publishes it: states, modules, diagnostics, events, and the
/// signals of each tick. Link thread only.
class Feeds {
 public:
  /// All outlive it.
  Feeds(const LinkSources& sources, Connections& connections);

  /// The answer to a hello, and the modules, if it is a client of our version that wants them.
  void greet(const Connection& connection) const;

  void publishState();
  /// Somebody listens to states or modules.
  [[nodiscard]] bool statesWanted() const noexcept;
  /// `notices`: beside those of the start.
  void publishDiagnostics(const Admission& admission, std::span<const std::string> notices);
  /// Events of the scheduler, and notes of other threads.
  void publishEvents();
  /// Rows of the trace since the last call.
  void publishTrace();
  /// To clients and the log.
  void tell(link::Event message);

  void chooseTrace(const link::TraceChoice& message, const Connection& connection);
  /// The connection has ended.
  void forget(std::uint64_t connection) { trace_desk_.forget(connection); }
  void countLateTicks();

 private:
  void publishModules(const Snapshot& snapshot);
  void recordAges(const Snapshot& snapshot);

  const LinkSources& sources_;
  Connections& connections_;
  Publication publication_;
  LateTickCauses late_causes_;
  DurationHistogram state_ages_;  ///< Age of the feedback in each state, when it is sent.
  TraceDesk trace_desk_;
  // One of each large message, filled in anew for every publication.
  link::State state_;
  link::Diagnostics diagnostics_;
  link::ModuleState module_state_;
  link::Trace trace_;
};

}  // namespace rc10
