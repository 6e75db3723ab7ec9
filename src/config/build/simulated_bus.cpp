#include "config/build/simulated_bus.hpp"

#include <string>
#include <utility>

#include "config/motor_families.hpp"

namespace rc10 {
namespace {

/// A copy: a recipe outlives the configuration that it was made from.
[[nodiscard]] sim::DriveRecipe recipeOf(const MotorConfig& motor) {
  auto of_drive = motor.settings;
  of_drive.id = motor.simulated_id.value_or(of_drive.id);
  return [settings = std::move(of_drive), load = motor.simulated]() -> Result<std::unique_ptr<sim::Drive>> {
    if (auto good = sim::checkLoad(settings.name, load); !good) return tl::unexpected(good.error());
    const auto* entry = findFamily(settings.model);
    if (entry == nullptr || entry->simulate == nullptr) {
      return fail("motor '" + settings.name + "': the " + settings.model +
                  " cannot be simulated; put it on a bus of type: socketcan");
    }
    return entry->simulate(settings, load);
  };
}

}  // namespace

sim::SimBusConfig simulatedBus(const BusConfig& config) {
  sim::SimBusConfig out;
  out.seed = config.sim_seed;
  for (const auto& motor : config.motors) {
    out.drives.push_back(recipeOf(motor));
    out.plans.push_back(motor.load_plan);
  }
  return out;
}

}  // namespace rc10
