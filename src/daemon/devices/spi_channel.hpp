#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/exchange/latest_value.hpp"
#include "module/device_needs.hpp"

namespace rc10 {

/// One SPI device between the scheduler, which has a new frame now and then, and the io thread, which sends
/// the newest. Neither waits.
struct SpiChannel {
  struct Settings {
    std::string name;  ///< Name of the module.
    std::string path;
    std::uint32_t speed_hz = 0;
    std::vector<std::uint8_t> rest;  ///< Sent at the end, and while no frames come.
  };
  struct Frame {
    std::uint32_t number = 0;  ///< 0: none yet.
    std::size_t size = 0;
    std::array<std::uint8_t, kMaxSpiBytes> bytes{};
  };

  explicit SpiChannel(Settings settings_of_device) : settings(std::move(settings_of_device)) {}

  const Settings settings;
  LatestValue<Frame> frame;       // scheduler -> io
  std::atomic<bool> open{false};  ///< Written by io.
};

/// Scheduler thread: hands over the frame that the module has made, if there is a new one, and tells it
/// whether the device is there.
void handOver(SpiChannel& channel, SpiOutput& output, std::uint32_t& handed_over) noexcept;

}  // namespace rc10
