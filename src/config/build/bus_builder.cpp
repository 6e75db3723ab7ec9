#include "config/build/bus_builder.hpp"

#include <algorithm>

#include "config/check/bus_id_check.hpp"
#include "config/check/bus_load_check.hpp"
#include "config/check/drive_id_check.hpp"

namespace rc10 {
namespace {

/// Motors with a command_divider take turns.
void spreadPhases(std::vector<MotorDraft>& motors) {
  int divided = 0;
  for (auto& motor : motors) {
    auto& settings = motor.config.settings;
    if (settings.command_divider > 1) settings.command_phase = divided++ % settings.command_divider;
  }
}

}  // namespace

BusConfig BusBuilder::build(const YamlNode& node, const std::string& path) {
  const Settings settings{{{&node, path}}};
  BusConfig bus;
  bus.place = node.place;
  readPlain(settings, bus);
  checkInterface(settings, bus, path);
  checkDataBitrate(settings, bus);

  auto drafts = buildMotors(settings);
  checkBitrate(settings, bus, drafts);
  spreadPhases(drafts);
  checkDriveIds(drafts, problems_);
  checkBusIds(drafts, bus, problems_);
  for (const auto& draft : drafts) bus.motors.push_back(draft.config);
  const bool all_known =
      std::all_of(drafts.begin(), drafts.end(), [](const auto& draft) { return draft.complete; });
  if (all_known) checkBusLoad(bus, rate_hz_, path, problems_);
  return bus;
}

void BusBuilder::readPlain(const Settings& settings, BusConfig& bus) {
  settings.read("name", bus.name);
  if (const auto name = settings.find("name")) bus_names_.add(*name, problems_);
  bus.type = settings.text("type") == "sim" ? BusType::kSimulated : BusType::kSocketCan;
  settings.read("interface", bus.interface);
  settings.read("bitrate", bus.bitrate);
  settings.read("data_bitrate", bus.data_bitrate);
  settings.read("sample_point", bus.sample_point);
  settings.read("data_sample_point", bus.data_sample_point);
  settings.read("manage_link", bus.manage_link);
  settings.read("foreign_frames", bus.foreign.frames);
  if (const auto within_ms = settings.number("foreign_ms"))
    bus.foreign.within = std::chrono::milliseconds{static_cast<int>(*within_ms)};
  if (const auto stalled_ms = settings.number("stalled_ms"))
    bus.stalled_after = std::chrono::milliseconds{static_cast<int>(*stalled_ms)};
  settings.section("sim").read("seed", bus.sim_seed);
}

void BusBuilder::checkDataBitrate(const Settings& settings, const BusConfig& bus) {
  const auto given = settings.find("data_bitrate");
  if (const auto point = settings.find("data_sample_point"); point && !settings.mentions("data_bitrate")) {
    problems_.error(point->place(), point->path,
                    "a classic bus has no data phase; add data_bitrate, or remove it");
  }
  if (!given) return;
  if (bus.data_bitrate < bus.bitrate) {
    problems_.error(given->place(), given->path,
                    given->text() + " bit/s is below the bit rate of " + std::to_string(bus.bitrate) +
                        "; the data phase is as fast or faster");
  }
}

void BusBuilder::checkInterface(const Settings& settings, const BusConfig& bus, const std::string& path) {
  const bool type_known = settings.find("type") || !settings.mentions("type");
  const auto interface = settings.find("interface");
  if (!type_known) return;
  if (bus.type == BusType::kSimulated) {
    if (interface)
      problems_.error(interface->place(), interface->path, "a simulated bus has no interface; remove it");
    if (const auto manage = settings.find("manage_link"); manage && bus.manage_link) {
      problems_.error(manage->place(), manage->path, "a simulated bus has no interface to manage; remove it");
    }
    if (const auto stalled = settings.find("stalled_ms");
        stalled && bus.stalled_after != BusConfig{}.stalled_after) {
      problems_.error(stalled->place(), stalled->path, "a simulated bus does not stall; remove it");
    }
  } else if (interface) {
    interfaces_.add(*interface, problems_);
  } else if (!settings.mentions("interface")) {
    problems_.error(bus.place, joinPath(path, "interface"),
                    "is missing; add the CAN interface (interface: can0), or write type: sim");
  }
}

void BusBuilder::checkBitrate(const Settings& settings, BusConfig& bus,
                              const std::vector<MotorDraft>& motors) {
  const auto bitrate = settings.find("bitrate");
  const auto only = [](const MotorDraft& motor) {
    return motor.config.family != nullptr ? motor.config.family->bitrate() : 0;
  };
  const auto motor = std::find_if(motors.begin(), motors.end(), [&](const MotorDraft& draft) {
    return only(draft) != 0 && only(draft) != bus.bitrate;
  });
  if (!bitrate || motor == motors.end()) return;
  const std::string rate = std::to_string(only(*motor));
  problems_.error(
      bitrate->place(), bitrate->path,
      std::string{motor->config.family->name()} + " drives speak " + rate + " bit/s only; use " + rate);
  bus.bitrate = only(*motor);
}

std::vector<MotorDraft> BusBuilder::buildMotors(const Settings& settings) {
  std::vector<MotorDraft> drafts;
  const auto motors = settings.find("motors");
  if (!motors) return drafts;
  for (std::size_t i = 0; i < motors->node->items.size(); ++i) {
    const YamlNode& node = motors->node->items[i];
    const std::string path = joinPath(motors->path, i);
    if (node.refused) continue;
    const auto given = profiles_.settingsOf(node, path, problems_);
    const Settings own{{{&node, path}}};
    if (given && !given->mentions("model")) {
      problems_.error(node.place, joinPath(path, "model"), "is missing; add it here or in a profile");
    }
    if (const auto name = own.find("name")) motor_names_.add(*name, problems_);
    drafts.push_back(buildMotor(given.value_or(own), node.place, path, rate_hz_, problems_));
  }
  return drafts;
}

}  // namespace rc10
