#pragma once

#include <memory>
#include <vector>

#include "app/result.hpp"
#include "bus/command_packer.hpp"
#include "bus/fdcan_bus.hpp"

namespace rc10 {

/// The bus on which a family builds its motors, and the packers that several of them share.
class BusParts {
 public:
  explicit BusParts(fdCANbus& bus) noexcept : bus_(bus) {}

  [[nodiscard]] fdCANbus& bus() noexcept { return bus_; }
  /// The shared packer that sends this id, if it is a Group.
  template <typename Group>
  [[nodiscard]] Group* find(CanId command_id) const noexcept {
    for (const auto& packer : owned_) {
      const auto ids = packer->commandIds();
      if (ids.front() == command_id) return dynamic_cast<Group*>(packer.get());
    }
    return nullptr;
  }
  /// Registers a packer with the bus and keeps it.
  [[nodiscard]] Result<void> add(std::unique_ptr<CommandPacker> packer);

 private:
  fdCANbus& bus_;
  std::vector<std::unique_ptr<CommandPacker>> owned_;
};

}  // namespace rc10
