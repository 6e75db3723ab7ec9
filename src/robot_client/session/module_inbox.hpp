#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "rc10/module.hpp"
#include "rc10/signals_t.hpp"
#include "rc10/subscriber.hpp"

namespace rc10 {
inline namespace robot_client {

/// States of a module, from now on. Any thread.
class ModuleInbox {
 public:
  /// `channel`: of the module, <robot>.v1.<module>.
  ModuleInbox(const LcmLink& link, const std::string& channel) : outputs_(link, channel + ".state") {}

  [[nodiscard]] ModuleState state() const;
  /// Whether a state ever came, with other definitions too.
  [[nodiscard]] bool heard() const { return outputs_.latest() != nullptr || foreign(); }
  /// False: nothing new within `timeout`.
  [[nodiscard]] bool waitForNext(Duration timeout) const { return outputs_.waitForNext(timeout) != nullptr; }
  /// Messages with other definitions came.
  [[nodiscard]] bool foreign() const { return outputs_.foreign() > 0; }

 private:
  Subscriber<signals_t> outputs_;
};

/// Inboxes of the modules that a program asked for. Any thread.
class ModuleInboxes {
 public:
  /// `channel`: as for ModuleInbox. Subscribed from the first call on; stays where it is.
  [[nodiscard]] const ModuleInbox& of(const LcmLink& link, const std::string& channel);

 private:
  std::mutex mutex_;
  std::map<std::string, std::unique_ptr<const ModuleInbox>> inboxes_;
};

/// Obstacle of these inputs for any module: their count, or a number that is not finite.
[[nodiscard]] Result<void> checkInputs(const std::string& module, const Signals& inputs,
                                       const SendOptions& options);

}  // namespace robot_client
}  // namespace rc10
