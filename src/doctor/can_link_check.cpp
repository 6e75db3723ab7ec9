#include "doctor/can_link_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace rc10::doctor {
namespace {

// Sample point, as a share of a bit. CiA 102 has 87.5 %, the kernel takes 75 % above 800 kbit/s, 80 % below
// it, 87.5 % below 500 kbit/s.
constexpr double kEarliestSample = 0.70;
constexpr double kLatestSample = 0.90;
constexpr double kUsualSample = 0.80;
constexpr double kUsualDataSample = 0.75;

// Frames that wait in the queue of a dead bus leave as a burst of old commands when it revives: ten frames
// are a tick or two, the 1000 of other networks 100 ms and more (lcm: cannelloni#90 states the same bound).
constexpr std::uint32_t kLongestQueue = 64;
constexpr std::uint32_t kGoodQueue = 16;

// A tick is 1 ms: a frame may not wait for a good part of it.
constexpr std::uint32_t kLongestDelayUs = 250;

// ISO 11898-1: from 96 on a controller warns, from 128 on it is passive.
constexpr int kWarningCounter = 96;

constexpr std::array<std::string_view, 5> kOrderKeepingQueues{"pfifo_fast", "pfifo", "noqueue", "mq", "prio"};

std::string percent(double share) {
  return std::to_string(static_cast<int>(std::lround(share * 1000.0)) / 10) + "." +
         std::to_string(static_cast<int>(std::lround(share * 1000.0)) % 10) + " %";
}

std::string rate(std::uint32_t bits_per_second) { return std::to_string(bits_per_second / 1000) + " kbit/s"; }

bool sampleOutside(std::optional<double> point) {
  return point && (*point < kEarliestSample || *point > kLatestSample);
}

std::string about(const CanLinkFacts& facts, const char* what) { return facts.interface + " " + what; }

std::string setDown(const CanLinkFacts& facts) { return "sudo ip link set " + facts.interface + " down"; }

CanLinkSettings settingsOf(const CanLinkFacts& facts) {
  auto wanted = facts.wanted;
  const auto link = facts.link.value_or(CanLink{});
  if (wanted.bitrate != 0) return wanted;
  wanted.bitrate = static_cast<int>(link.bitrate.value_or(1'000'000));
  if (link.fd_on) wanted.data_bitrate = static_cast<int>(link.data_bitrate.value_or(5'000'000));
  return wanted;
}

std::string command(const CanLinkFacts& facts, const CanLinkSettings& wanted) {
  CanLink controller;
  controller.kind = "can";
  return restartCommand(facts.interface, facts.link.value_or(controller), wanted, "sudo ");
}

// No fault if rc10d mends it by itself.
Finding judged(const CanLinkFacts& facts, const std::string& what, const std::string& why) {
  if (facts.managed) return pass(what, why + "; rc10d mends it (manage_link)");
  return fault(what, why, setupCommand(facts));
}

}  // namespace

std::string setupCommand(const CanLinkFacts& facts) { return command(facts, settingsOf(facts)); }

Finding checkUp(const CanLinkFacts& facts) {
  const std::string what = about(facts, "link");
  const auto link = facts.link.value_or(CanLink{});
  if (!link.is_can)
    return fault(what, "it is not a CAN interface",
                 "name the CAN interface in the configuration: `ip link show type can`");
  if (link.up)
    return pass(what,
                link.kind.empty() ? "up" : "up (" + (facts.driver.empty() ? link.kind : facts.driver) + ")");
  if (facts.managed) return pass(what, "down; rc10d brings it up (manage_link)");
  return fault(what, "down", setupCommand(facts));
}

Finding checkBitrate(const CanLinkFacts& facts) {
  const std::string what = about(facts, "bit rate");
  const auto link = facts.link.value_or(CanLink{});
  if (!link.isController()) return pass(what, "a " + link.kind + " has none");
  if (!link.bitrate) {
    if (facts.managed) return pass(what, "not set; rc10d sets it (manage_link)");
    return fault(what, "never set", setupCommand(facts));
  }
  if (facts.wanted.bitrate == 0)
    return pass(what, rate(*link.bitrate) + " (no configuration to compare with: --config FILE)");
  if (sameBitrate(*link.bitrate, facts.wanted.bitrate))
    return pass(what, rate(*link.bitrate) + ", as configured");
  return judged(facts, what,
                rate(*link.bitrate) + " instead of the configured " +
                    rate(static_cast<std::uint32_t>(facts.wanted.bitrate)) +
                    ": no drive understands a frame");
}

Finding checkSamplePoint(const CanLinkFacts& facts) {
  const std::string what = about(facts, "sample point");
  const auto link = facts.link.value_or(CanLink{});
  if (!link.sample_point) return pass(what, "not known");
  std::string found = percent(*link.sample_point);
  if (link.fd_on && link.data_sample_point) found += ", data " + percent(*link.data_sample_point);
  const auto& wanted = facts.wanted;
  const bool as_wanted = sameSamplePoint(*link.sample_point, wanted.sample_point) &&
                         (!link.fd_on || !link.data_sample_point ||
                          sameSamplePoint(*link.data_sample_point, wanted.data_sample_point));
  if (!as_wanted) {
    return judged(facts, what,
                  found + " instead of the configured " +
                      percent(wanted.sample_point != 0.0 ? wanted.sample_point : *link.sample_point) +
                      (wanted.data_sample_point != 0.0 ? ", data " + percent(wanted.data_sample_point) : ""));
  }
  const bool chosen = wanted.sample_point != 0.0 && (!link.fd_on || wanted.data_sample_point != 0.0);
  if (chosen) return pass(what, found + ", as configured");
  if (!sampleOutside(link.sample_point) && !(link.fd_on && sampleOutside(link.data_sample_point)))
    return pass(what, found);
  auto usual = settingsOf(facts);
  usual.sample_point = kUsualSample;
  usual.data_sample_point = kUsualDataSample;
  return warn(what, found + ": outside 70 to 90 %, so that drives at the end of a long cable misread frames",
              command(facts, usual));
}

Finding checkFdMode(const CanLinkFacts& facts) {
  const std::string what = about(facts, "FD mode");
  const auto link = facts.link.value_or(CanLink{});
  if (const auto* mode = hinderingMode(link))
    return judged(facts, what, std::string(mode->name) + ": " + std::string(mode->consequence));
  if (!link.isController()) return pass(what, "a " + link.kind + " takes what it is given");
  if (facts.wanted.data_bitrate != 0) {
    if (!link.fd_on)
      return judged(facts, what, "off; the configuration has data_bitrate, drives need FD frames");
    const auto wanted = rate(static_cast<std::uint32_t>(facts.wanted.data_bitrate));
    if (!sameBitrate(link.data_bitrate.value_or(0), facts.wanted.data_bitrate))
      return judged(facts, what,
                    "data phase " + (link.data_bitrate ? rate(*link.data_bitrate) : "not set") +
                        " instead of " + wanted);
    return pass(what, "on, data phase " + wanted);
  }
  if (!link.fd_on) return pass(what, "off");
  if (facts.wanted.bitrate == 0) return pass(what, "on (no configuration to compare with)");
  const std::string why =
      "on, and the configuration has a classic bus: an SPI controller then moves 64 bytes for each frame of "
      "8";
  return facts.managed ? judged(facts, what, why) : warn(what, why, setupCommand(facts));
}

Finding checkRestart(const CanLinkFacts& facts) {
  const std::string what = about(facts, "automatic restart");
  const auto link = facts.link.value_or(CanLink{});
  if (link.restart_ms == 0) return pass(what, "restart-ms 0: none");
  return judged(facts, what,
                "restart-ms " + std::to_string(link.restart_ms) +
                    ": after bus-off old commands go out unseen; with mcp251xfd the kernel may crash "
                    "(raspberrypi/linux#6916)");
}

Finding checkQueue(const CanLinkFacts& facts) {
  const std::string what = about(facts, "send queue");
  const auto link = facts.link.value_or(CanLink{});
  const bool keeps_order =
      link.qdisc.empty() || std::find(kOrderKeepingQueues.begin(), kOrderKeepingQueues.end(), link.qdisc) !=
                                kOrderKeepingQueues.end();
  // A link that is down has no queue yet.
  if (link.up && !keeps_order && link.qdisc != "noop") {
    return fault(what, "qdisc " + link.qdisc + " drops CAN frames without a word (systemd#9194)",
                 "sudo tc qdisc replace dev " + facts.interface +
                     " root pfifo_fast   # for good: sysctl net.core.default_qdisc=pfifo_fast");
  }
  const std::string found = (link.qdisc.empty() ? "" : "qdisc " + link.qdisc + ", ") + "txqueuelen " +
                            std::to_string(link.queue_length);
  if (link.queue_length > kLongestQueue && link.isController()) {
    return warn(what, found + ": what waits there goes out as old commands when a bus revives",
                "sudo ip link set " + facts.interface + " txqueuelen " + std::to_string(kGoodQueue));
  }
  return pass(what, found);
}

Finding checkErrors(const CanLinkFacts& facts) {
  const std::string what = about(facts, "errors");
  const auto link = facts.link.value_or(CanLink{});
  const std::string wiring =
      "check termination (60 ohm between CAN_H and CAN_L without power), wiring and bit rates; then " +
      setupCommand(facts);
  if (link.state == CanState::kBusOff) return fault(what, "bus-off: the controller has given up", wiring);
  const int tec = link.tec.value_or(0);
  const int rec = link.rec.value_or(0);
  std::string found;
  if (link.tec) found = "TEC " + std::to_string(tec) + ", REC " + std::to_string(rec);
  if (link.times_bus_off != 0) found += ", " + std::to_string(link.times_bus_off) + " times bus-off";
  if (link.times_passive != 0) found += ", " + std::to_string(link.times_passive) + " times passive";
  if (link.bus_errors != 0) found += ", " + std::to_string(link.bus_errors) + " bus errors";
  if (link.rx_lost != 0) found += ", " + std::to_string(link.rx_lost) + " received frames lost";
  if (found.empty()) found = "none";
  if (found.rfind(", ", 0) == 0) found.erase(0, 2);
  if (link.state == CanState::kPassive || tec >= kWarningCounter || rec >= kWarningCounter) {
    return warn(what, found + ": nobody acknowledges, or frames are destroyed", wiring);
  }
  if (link.rx_lost != 0)
    return warn(
        what, found + ": the computer did not fetch them in time",
        "raise the priority of the interrupt threads (above); lower the load of the bus: `rc10ctl stats`");
  if (link.times_bus_off != 0) return warn(what, found + " since the interface exists", wiring);
  return pass(what, found);
}

Finding checkCoalescing(const CanLinkFacts& facts) {
  const std::string what = about(facts, "coalescing");
  if (!facts.coalescing) return pass(what, "this driver has none");
  const auto& now = *facts.coalescing;
  const std::string found =
      "rx-frames-irq " + std::to_string(now.rx_frames) + ", rx-usecs-irq " + std::to_string(now.rx_delay_us);
  const std::string fix = setDown(facts) + "; sudo ethtool -C " + facts.interface +
                          " rx-usecs-irq 0 rx-frames-irq 1; sudo ip link set " + facts.interface + " up";
  if (now.rx_frames > 1 && now.rx_delay_us == 0)
    return fault(what, found + ": a frame waits until others have come (raspberrypi/linux#6407)", fix);
  if (now.rx_frames > 1 && now.rx_delay_us > kLongestDelayUs)
    return warn(what, found + ": feedback is up to that much older", fix);
  return pass(what, found);
}

Findings checkCanLink(const CanLinkFacts& facts) {
  if (!facts.link) {
    return {fault(about(facts, "link"), "there is no such interface" + facts.similar,
                  "`ip link` lists what there is. A HAT needs its overlay in /boot/firmware/config.txt "
                  "(docs/can-setup.md); "
                  "to try without hardware: sudo ip link add " +
                      facts.interface + " type vcan")};
  }
  Findings findings{checkUp(facts)};
  if (!facts.link->is_can) return findings;
  for (const auto check :
       {checkBitrate, checkSamplePoint, checkFdMode, checkRestart, checkQueue, checkErrors, checkCoalescing})
    findings.push_back(check(facts));
  return findings;
}

}  // namespace rc10::doctor
