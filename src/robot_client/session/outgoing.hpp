#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "rc10/lcm_link.hpp"
#include "rc10/module.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

/// "left,right": how a request names its motors.
[[nodiscard]] std::string joined(const std::vector<std::string>& names);

/// Messages from one client to one robot, numbered. One thread at a time: a message must not be overtaken by
/// one with a higher number.
class Outgoing {
 public:
  Outgoing(LcmLink link, std::string robot, std::string client, int priority);

  [[nodiscard]] std::string channel(const std::string& kind) const { return robot_ + ".v1." + kind; }
  [[nodiscard]] std::int64_t session() const noexcept { return session_; }
  /// A number for a request, which keeps it when it is sent again.
  [[nodiscard]] std::int64_t nextNumber() noexcept { return ++seq_; }

  Result<void> command(const MotorSetpoints& setpoints, std::chrono::milliseconds validity);
  Result<void> inputs(const std::string& module, const Signals& inputs, const SendOptions& options);
  Result<void> request(std::int64_t number, const std::string& operation, const std::string& target,
                       const std::map<std::string, double>& values);

 private:
  const LcmLink link_;
  const std::string robot_;
  const std::string client_;
  const int priority_;
  const std::int64_t session_;
  std::int64_t seq_ = 0;
};

}  // namespace robot_client
}  // namespace rc10
