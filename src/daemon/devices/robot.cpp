#include "daemon/devices/robot.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "bus/can_socket.hpp"
#include "config/build/robot_outline.hpp"
#include "config/build/simulated_bus.hpp"
#include "sim/sim_bus.hpp"

namespace rc10 {
namespace {

// A tick, and an echo with it, may be this much early.
constexpr Duration kTickJitter = std::chrono::microseconds{500};

// One DJI command frame carries four motors; a bus with all of them has five. Other drives have one each,
// in their turn.
[[nodiscard]] CanSocketOptions socketOptions(const BusConfig& config) {
  std::size_t shared = 0;
  std::size_t own = 0;
  for (const auto& motor : config.motors) {
    const bool shares = !motor.family->busUse(motor.settings).layout.empty();
    ++(shares ? shared : own);
  }
  return {.frames_per_tick = static_cast<int>(shared / 4 + own + 1)};
}

// The ids of the packer that has, among its rest frames, the id that wins arbitration against all others: on
// a crowded bus only a stall delays its echoes. All its ids, since a drive may have an id for each
// command; by its rest frames, as they probe a stalled bus.
[[nodiscard]] std::vector<CanId> mostUrgent(const fdCANbus& bus) {
  const auto rank = [](CanId id) { return id.extended ? id.value * 2 + 1 : id.value << 19U; };
  std::vector<CanId> watched;
  std::optional<CanId> best;
  std::array<CanFrame, kMaxFramesPerPacker> frames;
  for (const auto* packer : bus.packers()) {
    for (const auto& frame : std::span{frames}.first(packer->packRest(frames))) {
      if (best && rank(frame.id) >= rank(*best)) continue;
      best = frame.id;
      const auto ids = packer->commandIds();
      watched.assign(ids.begin(), ids.end());
    }
  }
  const bool listed = !best || std::find(watched.begin(), watched.end(), *best) != watched.end();
  if (!listed) watched.push_back(*best);
  return watched;
}

}  // namespace

Result<std::unique_ptr<Robot>> Robot::build(const RobotConfig& config) {
  auto robot = std::unique_ptr<Robot>(new Robot);
  robot->period_ = config.period();
  robot->unrest_ = config.unrest;
  for (const auto& bus : config.buses) {
    auto added = bus.type == BusType::kSocketCan ? robot->addSocketCan(bus) : robot->addSimulated(bus);
    if (!added) return tl::unexpected(added.error());
  }
  robot->coupled_ = config.groups;
  if (auto added = robot->addModules(config); !added) return tl::unexpected(added.error());
  return robot;
}

Result<void> Robot::addSocketCan(const BusConfig& config) {
  const auto options = socketOptions(config);
  auto bus = fdCANbus::open(config.name, config.interface, options);
  if (!bus) return tl::unexpected(bus.error());
  if (config.data_bitrate > 0 && !(*bus)->fdFrames()) {
    const auto link = readCanLink(config.interface);
    if (!link) return tl::unexpected(link.error());
    return fail(fmt::format("bus '{}': interface {} does not take CAN FD frames; type: {}", config.name,
                            config.interface,
                            restartCommand(config.interface, *link, config.linkSettings())));
  }
  buses_.push_back({.bus = std::move(*bus),
                    .interface = config.interface,
                    .options = options,
                    .settings = config.linkSettings(),
                    .manage_link = config.manage_link,
                    .foreign = config.foreign});
  auto& entry = buses_.back();
  entry.bus->health() = BusHealth{{.stalled_after = config.stalled_after - kTickJitter}};
  if (auto added = addMotors(config); !added) return added;
  if (entry.bus->packers().empty()) return {};
  auto echo = openEchoSocket(config.interface, entry.watched);
  if (!echo) return tl::unexpected(echo.error());
  entry.echo = std::move(*echo);
  return {};
}

Result<void> Robot::addSimulated(const BusConfig& config) {
  auto ends = sim::SimPort::makeSocketPair();
  if (!ends) return tl::unexpected(ends.error());
  buses_.push_back({.bus = fdCANbus::adopt(config.name, std::move(ends->first), true),
                    .foreign = config.foreign,
                    .simulated = true});
  if (auto added = addMotors(config); !added) return added;
  const auto drives = simulatedBus(config);
  if (auto checked = sim::SimBus::check(drives); !checked) return checked;
  sim_ports_.push_back(std::make_unique<sim::SimPort>(std::move(ends->second), drives, sim::Stamps::kOwn));
  return {};
}

// One lost frame of a drive that speaks seldom is no restart.
Duration Robot::restartUnheard(const MotorConfig& config, const Motor_Base& motor) {
  const Duration start = config.traits().unseen_start;
  return start > Duration::zero() ? std::max(start, 5 * motor.feedbackPeriod() / 2) : Duration::max();
}

Result<void> Robot::addMotors(const BusConfig& config) {
  for (const auto& motor : config.motors) {
    if (auto added = addMotor(motor, buses_.size() - 1); !added) return added;
  }
  auto& entry = buses_.back();
  if (entry.bus->packers().empty()) return {};
  entry.watched = mostUrgent(*entry.bus);
  entry.bus->watch(entry.watched);
  return {};
}

Result<void> Robot::addMotor(const MotorConfig& config, std::size_t bus_index) {
  auto& entry = buses_[bus_index];
  if (!entry.parts) entry.parts = std::make_unique<BusParts>(*entry.bus);
  auto motor = config.family->build(config.settings, *entry.parts);
  if (!motor) return tl::unexpected(motor.error());
  const Duration restart_unheard = restartUnheard(config, **motor);
  entry.feedback_expected |= (*motor)->speaksUnasked();
  auto use = config.family->busUse(config.settings);
  auto shaping = config.shaping;
  shaping.feedback_period_s = seconds((*motor)->feedbackPeriod());
  shaping.command_period_s = seconds(std::max(config.settings.command_divider, 1) * period_);
  // The age may be half of the timeout, which spans two periods of the feedback at least; two periods of the
  // ticks are for their jitter, so that without a pause the clock decides.
  motors_.push_back(
      {.motor = std::move(*motor),
       .bus = bus_index,
       .feedback_timeout = config.feedback_timeout,
       .oldest_heard = config.feedback_timeout / 2,
       .most_unheard = std::max(config.feedback_timeout / 2, config.feedback_timeout - 2 * period_),
       .restart_unheard = restart_unheard,
       .guard = config.guard,
       .rest = config.rest,
       .shaping = shaping,
       .reduced = config.reduced,
       .fallback = config.fallback,
       .standstill_rpm = config.standstill_rpm,
       .run_down = config.run_down,
       .divided = config.settings.command_divider > 1,
       .optional = config.optional,
       .id = config.settings.id,
       .steers = use.steering(),
       .obeys = std::move(use.obeys)});
  return {};
}

Result<void> Robot::addModules(const RobotConfig& config) {
  const RobotOutline outline = outlineOf(config);
  std::vector<ModuleDirectory::Entry> entries;
  modules_.reserve(config.modules.size());
  for (const auto& module : config.modules) {
    for (std::size_t i = 0; i < motors_.size(); ++i)
      motors_[i].homed |= module.type->homes(module.settings, i);
    auto built = module.type->build(module.settings, outline);
    if (!built) return fail(fmt::format("module '{}': {}", module.settings.name, built.error().message));
    modules_.push_back({module.settings.name, module.settings.priority, std::move(*built)});
    entries.push_back({modules_.back().name, modules_.back().module.get()});
  }
  const ModuleDirectory directory{entries};
  for (auto& entry : modules_) {
    if (auto connected = entry.module->connect(directory); !connected)
      return fail(fmt::format("module '{}': {}", entry.name, connected.error().message));
  }
  if (auto added = addSerialPorts(); !added) return added;
  addSpiDevices();
  return addGpioLines();
}

Result<void> Robot::addSerialPorts() {
  std::vector<SerialChannel::Settings> ports;
  std::vector<std::unique_ptr<I_Protocol>> protocols;
  std::vector<Module_Base*> users;
  for (auto& entry : modules_) {
    auto need = entry.module->takeSerialNeed();
    if (!need) continue;
    ports.push_back({.name = entry.name, .path = need->path, .format = need->format});
    protocols.push_back(std::move(need->protocol));
    users.push_back(entry.module.get());
  }
  if (ports.empty()) return {};
  auto channels = SerialChannels::create(ports);
  if (!channels) return tl::unexpected(channels.error());
  serial_channels_ = std::move(*channels);
  for (std::size_t i = 0; i < ports.size(); ++i) {
    auto& channel = (*serial_channels_)[i];
    serial_devices_.push_back(
        {std::make_unique<SerialDevice>(ports[i].name, std::move(protocols[i]), channel.outbox), i});
    users[i]->useSerial(*serial_devices_.back().device);
  }
  return {};
}

void Robot::addSpiDevices() {
  for (auto& entry : modules_) {
    auto need = entry.module->takeSpiNeed();
    if (!need) continue;
    spi_outputs_.push_back({.output = std::move(need->output), .channel = spi_channels_.size()});
    spi_channels_.push_back(
        std::make_unique<SpiChannel>(SpiChannel::Settings{.name = entry.name,
                                                          .path = std::move(need->path),
                                                          .speed_hz = need->speed_hz,
                                                          .rest = std::move(need->rest)}));
  }
}

Result<void> Robot::addGpioLines() {
  std::vector<LineBank::Settings> banks;
  for (auto& entry : modules_) {
    auto need = entry.module->takeGpioNeed();
    if (!need) continue;
    gpio_images_.push_back({.image = std::move(need->image), .bank = banks.size()});
    banks.push_back({.name = entry.name,
                     .chip = std::move(need->chip),
                     .inputs = std::move(need->inputs),
                     .outputs = std::move(need->outputs),
                     .safe_levels = need->safe_levels});
  }
  if (banks.empty()) return {};
  auto created = LineBanks::create(std::move(banks));
  if (!created) return tl::unexpected(created.error());
  line_banks_ = std::move(*created);
  return {};
}

}  // namespace rc10
