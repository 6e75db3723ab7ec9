#include "robot_client/session/session_modules.hpp"

#include "app/nearest.hpp"
#include "robot_client/session/names_heard.hpp"

namespace rc10 {
inline namespace robot_client {

const ModuleInbox& SessionModules::inboxOf(const std::string& module) {
  return inboxes_.of(core_.link, core_.outgoing.channel(module));
}

Result<void> SessionModules::send(const std::string& module, const Signals& inputs,
                                  const SendOptions& options) {
  if (!core_.status) return core_.status;
  auto done = checkInputs(module, inputs, options);
  bool missing = false;
  if (done) {
    const bool heard = inboxOf(module).heard();
    // Sent under the mutex: another thread's message with a higher number must not overtake it.
    const SessionCore::Lock lock(core_.mutex);
    const auto now = timeNow();
    targets_.aliveAt(now);
    done = core_.closed ? fail("the robot is closed") : core_.outgoing.inputs(module, inputs, options);
    if (done) in_force_.give(module, inputs, options, now);
    missing = done && silent_.sent(module, heard, core_.newest.live(now), now);
  }
  if (missing)
    core_.problems.tell("robot '" + core_.name + "' is heard, and nothing of module '" + module +
                        "' to which inputs are sent: `rc10ctl modules` shows which there are");
  if (!done) core_.problems.tell(done.error().message);
  return done;
}

void SessionModules::letGo(MonotonicTime now) {
  for (const auto& [module, given] : in_force_.takeAll(now))
    (void)core_.outgoing.inputs(module, given.inputs, given.options);
}

double SessionModules::output(const std::string& module, std::string_view output) {
  const auto known = state(module);
  if (known && known.outputs.find(output) == known.outputs.end()) {
    std::vector<std::string_view> names;
    for (const auto& [name, value] : known.outputs) names.emplace_back(name);
    core_.problems.tell(module + " has no output '" + std::string(output) + "'; there are " +
                        known.outputNames() + didYouMean(output, names));
  }
  return known[output];
}

Result<void> SessionModules::waitForState(const std::string& module, Duration timeout) {
  if (auto may = core_.mayWait(module + ".waitForState()"); !may) return may;
  const auto& inbox = inboxOf(module);
  NamesHeard modules(core_.link, core_.outgoing.channel(""), ".state");
  if (inbox.waitForNext(timeout)) return {};
  if (inbox.foreign()) core_.foreign(core_.outgoing.channel(module) + ".state");
  if (const auto names = modules.names(NamesHeard::kListen); !names.empty() && names.count(module) == 0) {
    return fail("nothing of module '" + module + "' within " + inMs(timeout) + ". Heard here: module " +
                listOf(names) + didYouMean(module, {names.begin(), names.end()}));
  }
  return fail("nothing of module '" + module + "' within " + inMs(timeout) +
              ": `rc10ctl modules` shows which there are. " + core_.whatToCheck());
}

}  // namespace robot_client
}  // namespace rc10
