#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bus/can_link_settings.hpp"
#include "doctor/finding.hpp"

namespace rc10::doctor {

/// When a driver tells the CPU that frames have come: `ethtool -c`.
struct Coalescing {
  std::uint32_t rx_delay_us = 0;  ///< rx-usecs-irq; 0: no such timer.
  std::uint32_t rx_frames = 0;    ///< rx-frames-irq; 0 or 1: at each frame.
};

/// A CAN interface as it is, and as the configuration wants it.
struct CanLinkFacts {
  std::string interface;
  std::optional<CanLink> link;  ///< Empty: there is none of this name.
  std::string similar;          ///< Then: "; did you mean can0?", or nothing.
  std::string driver;           ///< "mcp251xfd"; empty: virtual.
  std::optional<Coalescing> coalescing;
  CanLinkSettings wanted;  ///< A bit rate of 0: no configuration was given.
  bool managed = false;    ///< rc10d brings it up itself.
};

/// The commands that set the interface up as wanted; without a configuration, as it is.
[[nodiscard]] std::string setupCommand(const CanLinkFacts& facts);

/// Everything about one interface.
[[nodiscard]] Findings checkCanLink(const CanLinkFacts& facts);

// Its parts, for an interface that is there.
[[nodiscard]] Finding checkUp(const CanLinkFacts& facts);
[[nodiscard]] Finding checkBitrate(const CanLinkFacts& facts);
[[nodiscard]] Finding checkSamplePoint(const CanLinkFacts& facts);
[[nodiscard]] Finding checkFdMode(const CanLinkFacts& facts);
[[nodiscard]] Finding checkRestart(const CanLinkFacts& facts);
[[nodiscard]] Finding checkQueue(const CanLinkFacts& facts);
[[nodiscard]] Finding checkErrors(const CanLinkFacts& facts);
[[nodiscard]] Finding checkCoalescing(const CanLinkFacts& facts);

}  // namespace rc10::doctor
