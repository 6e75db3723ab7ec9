#include "daemon/interfaces/interface_wait.hpp"

#include <net/if.h>
#include <poll.h>

#include <algorithm>
#include <utility>

namespace rc10 {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{50};

}  // namespace

InterfaceWait::InterfaceWait(const RobotConfig& config, Exists exists) : exists_(std::move(exists)) {
  for (const auto& bus : config.buses) {
    if (bus.type == BusType::kSocketCan) interfaces_.push_back(bus.interface);
  }
}

std::string InterfaceWait::missing() const {
  const auto found = std::find_if_not(interfaces_.begin(), interfaces_.end(),
                                      [this](const auto& name) { return exists_(name); });
  return found == interfaces_.end() ? std::string{} : *found;
}

InterfaceWait::End InterfaceWait::run(int wakes, Duration longest) const {
  for (Duration waited{0}; !missing().empty(); waited += kLook) {
    if (waited >= longest) return End::kTooLong;
    pollfd signal{.fd = wakes, .events = POLLIN, .revents = 0};
    const auto look_ms =
        static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(kLook).count());
    if (::poll(&signal, 1, look_ms) > 0) return End::kSignal;
  }
  return End::kThere;
}

bool InterfaceWait::kernelHas(const std::string& interface) {
  return ::if_nametoindex(interface.c_str()) != 0;
}

}  // namespace rc10
