#include "daemon/clients/signal_admission.hpp"

#include <algorithm>
#include <cmath>

#include "app/message_limits.hpp"

namespace rc10 {

// The limits of the client library are those of the daemon.
static_assert(kMaxMessageSignals == kMaxSignals && kMaxMessageSignals == link::kMaxSignals);
static_assert(kMaxNameBytes + 1 == sizeof(link::Name));

SignalAdmission::SignalAdmission(std::vector<KnownModule> modules)
    : modules_(std::move(modules)), sessions_(modules_.size()) {}

CommandRefusal SignalAdmission::admit(const link::Signals& message, MonotonicTime now, SignalMessage& out) {
  const auto known = std::find_if(modules_.begin(), modules_.end(), [&](const KnownModule& module) {
    return module.name == message.module.view();
  });
  if (known == modules_.end()) return CommandRefusal::kUnknownModule;
  const auto deadline = deadlineOf(message.received_ns, message.validity_ms, now);
  if (message.value_count == 0 || message.value_count > kMaxSignals || !deadline)
    return CommandRefusal::kMalformed;
  out.values.fill(kNoSignal);
  for (std::size_t i = 0; i < message.value_count; ++i) {
    const auto& given = message.values[i];
    const auto input = std::find(known->inputs.begin(), known->inputs.end(), given.name.view());
    if (input == known->inputs.end()) return CommandRefusal::kUnknownSignal;
    if (!std::isfinite(given.value)) return CommandRefusal::kNotFinite;
    double& place = out.values[static_cast<std::size_t>(input - known->inputs.begin())];
    if (!std::isnan(place)) return CommandRefusal::kMalformed;
    place = given.value;
  }
  if (now >= *deadline) return CommandRefusal::kExpired;
  if (!budget_.spend(message.client.view(), message.value_count, now)) return CommandRefusal::kRingFull;
  const auto module = static_cast<std::size_t>(known - modules_.begin());
  out.module = static_cast<std::uint16_t>(module);
  out.client = message.client;
  out.session = message.session;
  out.priority = message.priority;
  out.deadline = *deadline;
  const bool new_number = sessions_[module].accept(message.client.view(), message.session, message.seq);
  return new_number ? CommandRefusal::kNone : CommandRefusal::kOldSequence;
}

}  // namespace rc10
