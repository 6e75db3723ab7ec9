#include "motor/bus_parts.hpp"

#include <utility>

namespace rc10 {

Result<void> BusParts::add(std::unique_ptr<CommandPacker> packer) {
  if (auto registered = bus_.registerMotor(*packer); !registered) return registered;
  owned_.push_back(std::move(packer));
  return {};
}

}  // namespace rc10
