#include "bus/can_link_settings.hpp"

#include <linux/can/netlink.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace rc10 {
namespace {

// At 8 Mbit/s a clock of 40 MHz has five quanta a bit: the nearest point is up to 10 % away.
constexpr double kSamplePointTolerance = 0.1;

// linux/can/netlink.h
constexpr std::array kHinderingModes{
    HinderingMode{CAN_CTRLMODE_LISTENONLY, "listen-only", "nothing can be sent"},
    HinderingMode{CAN_CTRLMODE_LOOPBACK, "loopback", "the controller talks to itself"},
    HinderingMode{CAN_CTRLMODE_ONE_SHOT, "one-shot", "a frame that loses arbitration is never sent"},
    HinderingMode{CAN_CTRLMODE_PRESUME_ACK, "presume-ack", "a bus without any drive looks like a good one"},
    HinderingMode{CAN_CTRLMODE_FD_NON_ISO, "fd-non-iso", "drives speak the CAN FD of ISO 11898-1:2015"},
};

[[nodiscard]] std::string share(double value) {
  char text[16];
  (void)std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

[[nodiscard]] std::string isSetTo(const std::string& interface, const std::string& seen,
                                  const std::string& wanted) {
  return interface + " is set to " + seen + ", the configuration says " + wanted;
}

[[nodiscard]] std::string wrongRate(const std::string& interface, const CanLink& link,
                                    const CanLinkSettings& wanted) {
  if (link.bitrate && !sameBitrate(*link.bitrate, wanted.bitrate)) {
    return isSetTo(interface, std::to_string(*link.bitrate) + " bit/s", std::to_string(wanted.bitrate));
  }
  if (wanted.data_bitrate == 0) {
    if (!link.fd_on) return {};
    return interface +
           " has CAN FD on, the configuration has a classic bus: an SPI controller then moves 64 bytes for "
           "each frame of 8";
  }
  if (!link.fd_on) return interface + " has CAN FD off, the configuration has data_bitrate";
  const auto data_bitrate = link.data_bitrate.value_or(0);
  if (!sameBitrate(data_bitrate, wanted.data_bitrate)) {
    return isSetTo(interface, std::to_string(data_bitrate) + " bit/s in the data phase",
                   std::to_string(wanted.data_bitrate));
  }
  return {};
}

[[nodiscard]] std::string wrongSamplePoint(const std::string& interface, const CanLink& link,
                                           const CanLinkSettings& wanted) {
  if (link.sample_point && !sameSamplePoint(*link.sample_point, wanted.sample_point)) {
    return isSetTo(interface, "sample point " + share(*link.sample_point), share(wanted.sample_point));
  }
  if (link.data_sample_point && !sameSamplePoint(*link.data_sample_point, wanted.data_sample_point)) {
    return isSetTo(interface, "sample point " + share(*link.data_sample_point) + " in the data phase",
                   share(wanted.data_sample_point));
  }
  return {};
}

[[nodiscard]] std::string wrongMode(const std::string& interface, const CanLink& link) {
  if (const auto* mode = hinderingMode(link)) {
    return interface + " has the mode " + std::string(mode->name) + " on: " + std::string(mode->consequence);
  }
  if (link.restart_ms != 0) {
    return interface + " restarts by itself " + std::to_string(link.restart_ms) +
           " ms after bus-off, again and again";
  }
  return {};
}

}  // namespace

std::string bitrates(const CanLinkSettings& wanted) {
  auto text = std::to_string(wanted.bitrate) + " bit/s";
  if (wanted.data_bitrate != 0) text += ", data " + std::to_string(wanted.data_bitrate) + " bit/s";
  return text;
}

bool sameBitrate(std::uint32_t seen, int wanted) noexcept {
  return std::abs(static_cast<double>(seen) - wanted) <= 0.01 * wanted;
}

bool sameSamplePoint(double seen, double wanted) noexcept {
  return wanted == 0.0 || std::abs(seen - wanted) <= kSamplePointTolerance;
}

const HinderingMode* hinderingMode(const CanLink& link) noexcept {
  const auto* const found =
      std::ranges::find_if(kHinderingModes, [&](const auto& mode) { return (link.modes & mode.flag) != 0; });
  return found == kHinderingModes.end() ? nullptr : found;
}

std::uint32_t hinderingModes(const CanLink& link) noexcept {
  std::uint32_t flags = 0;
  for (const auto& mode : kHinderingModes) flags |= link.modes & mode.flag;
  return flags;
}

std::string wrongSetting(const std::string& interface, const CanLink& link, const CanLinkSettings& wanted) {
  if (!link.isController()) return {};
  auto wrong = wrongRate(interface, link, wanted);
  if (wrong.empty()) wrong = wrongSamplePoint(interface, link, wanted);
  return wrong.empty() ? wrongMode(interface, link) : wrong;
}

std::string upCommand(const std::string& interface, const CanLink& link, const CanLinkSettings& wanted) {
  // A virtual interface takes FD frames by its MTU.
  if (!link.isController())
    return "ip link set " + interface + (wanted.data_bitrate != 0 ? " mtu 72" : "") + " up";
  auto command = "ip link set " + interface + " up type can bitrate " + std::to_string(wanted.bitrate);
  if (wanted.sample_point != 0.0) command += " sample-point " + share(wanted.sample_point);
  if (wanted.data_bitrate != 0) {
    command += " dbitrate " + std::to_string(wanted.data_bitrate);
    if (wanted.data_sample_point != 0.0) command += " dsample-point " + share(wanted.data_sample_point);
    command += " fd on";
  } else if (link.fd_on) {
    command += " fd off";
  }
  for (const auto& mode : kHinderingModes) {
    if ((link.modes & mode.flag) != 0) command += " " + std::string(mode.name) + " off";
  }
  return command + " restart-ms 0";
}

std::string restartCommand(const std::string& interface, const CanLink& link, const CanLinkSettings& wanted,
                           const std::string& prefix) {
  return prefix + "ip link set " + interface + " down; " + prefix + upCommand(interface, link, wanted);
}

}  // namespace rc10
