#include "daemon/clients/scan_request.hpp"

#include <net/if.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/nearest.hpp"
#include "bus/frame_bits.hpp"

namespace rc10 {
namespace {

constexpr double kScanListenS = 2.0;
constexpr double kLeastListenS = 0.5;
constexpr double kMostListenS = 60.0;
// As `rc10ctl scan` on a bus of its own: a question of 8 bytes and its answer take 0.3 ms at 1 Mbit/s.
constexpr Duration kLeastBetween = std::chrono::milliseconds{2};
// A full bus is asked slowly, but within 20 s.
constexpr Duration kMostBetween = std::chrono::milliseconds{50};
constexpr double kLeastFree = 0.05;

// The questions take no more than half of what the robot's own frames leave.
[[nodiscard]] Duration paceOn(const RobotDescription::Bus& bus) {
  constexpr auto kBits = 2 * detail::frameBits({.extended = true, .length = 8}, true).total();
  const double free = std::max(kLeastFree, 1.0 - static_cast<double>(bus.predicted_load_worst));
  const double bitrate = bus.bitrate > 0.0 ? bus.bitrate : 1e6;
  const std::chrono::duration<double> pace{2.0 * kBits / bitrate / free};
  return std::clamp(std::chrono::duration_cast<Duration>(pace), kLeastBetween, kMostBetween);
}

[[nodiscard]] Result<std::size_t> busOf(std::string_view target, const RobotDescription& robot) {
  std::vector<std::string_view> names;
  names.reserve(robot.buses.size());
  for (std::size_t i = 0; i < robot.buses.size(); ++i) {
    if (target == robot.buses[i].name) return i;
    names.emplace_back(robot.buses[i].name);
  }
  // By its index an interface has one name, and others beside it.
  const auto wanted = ::if_nametoindex(std::string{target}.c_str());
  for (std::size_t i = 0; i < robot.buses.size(); ++i) {
    const auto& interface = robot.buses[i].interface;
    if (!target.empty() && target == interface) return i;
    if (wanted != 0 && wanted == ::if_nametoindex(interface.c_str())) return i;
  }
  return fail(fmt::format("scan: name one bus, not '{}'; the buses are: {}{}", target, fmt::join(names, ", "),
                          didYouMean(target, names)));
}

[[nodiscard]] const char* scanWords(Refusal refusal, bool begun) {
  switch (refusal) {
    case Refusal::kActive:
      return begun ? "enabled meanwhile: disable it and scan again" : "ENABLING or ACTIVE: disable it first";
    case Refusal::kFaulted: return "in FAULT: clear it first";
    case Refusal::kMoving: return "still turning: wait until it stands";
    case Refusal::kMayTurn:
      return "no feedback, and it may still turn: wait until run_down_s after its last feedback";
    case Refusal::kStillActs: return "still being damped, braked or held: disable it once more to let go";
    case Refusal::kConfiguring: return "its drive is being configured: wait for it";
    case Refusal::kStopping: return "rc10d is stopping";
    case Refusal::kScanning: return "another scan goes on: wait for it";
    case Refusal::kBusHeld: return "the bus carries no frames: see `rc10ctl stats`";
    case Refusal::kTooBusy: return "rc10d had no time to judge what was heard: scan again";
    case Refusal::kClientGone: return "its client was gone: scan again";
    default: return "not possible now";
  }
}

}  // namespace

Result<BusScanOrder> parseScan(const link::Request& request, const RobotDescription& robot) {
  const auto bus = busOf(request.target.view(), robot);
  if (!bus) return tl::unexpected(bus.error());
  BusScanOrder scan{.bus = *bus, .between = paceOn(robot.buses[*bus])};
  double listen_s = kScanListenS;
  for (const auto& value :
       std::span(request.values).first(std::min<std::size_t>(request.value_count, link::kMaxValues))) {
    if (value.name.view() == "listen_s") {
      listen_s = value.value;
    } else if (value.name.view() == "listen_only") {
      scan.listen_only = value.value != 0.0;
    } else {
      return fail(fmt::format("scan: there is no value '{}': listen_s and listen_only{}", value.name.view(),
                              didYouMean(value.name.view(), {"listen_s", "listen_only"})));
    }
  }
  if (!(listen_s >= kLeastListenS && listen_s <= kMostListenS))
    return fail(fmt::format("scan: listen_s: {} is out of range; use {} to {}", listen_s, kLeastListenS,
                            kMostListenS));
  scan.listen = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(listen_s));
  return scan;
}

MotorSet motorsOf(const RobotDescription& robot, std::size_t bus) {
  MotorSet motors;
  for (std::size_t i = 0; i < robot.motors.size(); ++i) motors.set(i, robot.motors[i].bus == bus);
  return motors;
}

std::string whyNoScan(const Order& order, const OrderResult& result, const RobotDescription& robot) {
  const bool begun = !result.refused;
  std::vector<std::string> reasons;
  if (result.scan != Refusal::kNone) reasons.emplace_back(scanWords(result.scan, begun));
  for (std::size_t i = 0; i < robot.motors.size(); ++i) {
    if (result.motors[i] != Refusal::kNone)
      reasons.push_back(fmt::format("{}: {}", robot.motors[i].name, scanWords(result.motors[i], begun)));
  }
  if (reasons.empty()) return {};
  return fmt::format("scan: {} {}: {}", robot.buses[order.scan.bus].name,
                     begun ? "was not scanned to the end" : "is scanned only while its motors rest",
                     fmt::join(reasons, "; "));
}

}  // namespace rc10
