#include "daemon/clients/signal_admission.hpp"

#include <algorithm>
#include <cmath>

#include "app/message_limits.hpp"

namespace rc10 {

// The limits of the client library are those of the daemon.
static_assert(kMaxMessageSignals == kMaxSignals && kMaxMessageSignals == link::kMaxSignals);
static_assert(kMaxNameBytes + 1 == sizeof(link::Name));

SignalAdmission::SignalAdmission(const RobotDescription& robot, Permissions permissions)
    : robot_(robot),
      permissions_(std::move(permissions)),
      sessions_(robot.modules.size()),
      budget_(robot.period()) {}

CommandRefusal SignalAdmission::admit(const link::Signals& message, const Speaker& speaker, MonotonicTime now,
                                      SignalMessage& out) {
  late_but_new_ = false;
  const auto& modules = robot_.modules;
  const auto known = std::find_if(modules.begin(), modules.end(),
                                  [&](const auto& module) { return module.name == message.module.view(); });
  if (known == modules.end()) return CommandRefusal::kUnknownModule;
  const auto deadline = deadlineOf(message.received_ns, message.validity_ms, now);
  if (message.value_count == 0 || message.value_count > kMaxSignals || !deadline)
    return CommandRefusal::kMalformed;
  const auto& inputs = known->signals.inputs;
  out.values.fill(kNoSignal);
  for (std::size_t i = 0; i < message.value_count; ++i) {
    const auto& given = message.values[i];
    const auto input = std::find(inputs.begin(), inputs.end(), given.name.view());
    if (input == inputs.end()) return CommandRefusal::kUnknownSignal;
    if (!std::isfinite(given.value)) return CommandRefusal::kNotFinite;
    double& place = out.values[static_cast<std::size_t>(input - inputs.begin())];
    if (!std::isnan(place)) return CommandRefusal::kMalformed;
    place = given.value;
  }
  const auto module = static_cast<std::size_t>(known - modules.begin());
  const auto client = message.client.view();
  not_permitted_ = permissions_.whyNoSignals(speaker, client, module, message.priority);
  if (!not_permitted_.empty()) return CommandRefusal::kNotPermitted;
  const bool late = now >= *deadline;
  if (!budget_.spend(speaker.account(client), message.value_count, now))
    return late ? CommandRefusal::kExpired : CommandRefusal::kRingFull;
  out.module = static_cast<std::uint16_t>(module);
  out.client = message.client;
  out.session = message.session;
  out.priority = message.priority;
  out.received = receivedAt(message.received_ns, now);
  out.deadline = *deadline;
  switch (sessions_[module].accept(speaker.owner(), client, message.session, message.seq)) {
    case SessionNumbers::Verdict::kNew:
      late_but_new_ = late;
      return late ? CommandRefusal::kExpired : CommandRefusal::kNone;
    case SessionNumbers::Verdict::kOld: return late ? CommandRefusal::kExpired : CommandRefusal::kOldSequence;
    case SessionNumbers::Verdict::kOfAnother: break;
  }
  not_permitted_ = permissions_.whyOtherSession(client);
  return CommandRefusal::kNotPermitted;
}

}  // namespace rc10
