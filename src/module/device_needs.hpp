#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rc10 {

/// Bytes that spidev sends in one transfer (its `bufsiz`, unless the kernel is told otherwise): more would be
/// two transfers with a gap between them.
inline constexpr std::size_t kMaxSpiBytes = 4096;

/// SPI transfer of a module. Plain memory of the scheduler thread: the module writes, and the
/// daemon hands it to the thread that sends. Of frames that come too fast only the newest is sent.
struct SpiOutput {
  std::uint32_t frames = 0;  ///< Count of frames: one more is a new frame.
  std::size_t size = 0;
  std::array<std::uint8_t, kMaxSpiBytes> bytes{};
  bool open = false;  ///< The device is there. Written by the daemon.
};

/// An SPI device that a module wants.
struct SpiNeed {
  std::string path;
  std::uint32_t speed_hz = 0;
  std::vector<std::uint8_t> rest;  ///< Sent at the end, and while no frames come.
  std::unique_ptr<SpiOutput> output;
};

/// The levels of a module's lines, by their places in the need. Plain memory of the scheduler thread, brought
/// up to date by the daemon before and after each update(). Electrical: 1 is high.
struct GpioImage {
  bool open = false;            ///< All lines are held and answer; otherwise the rest means nothing.
  std::uint32_t inputs = 0;     ///< Written by the daemon.
  std::uint32_t unwritten = 0;  ///< Outputs that did not take their last level. Written by the daemon.
  std::uint32_t readings = 0;   ///< Counts, and wraps: `inputs` is as old as the last change of this.
  std::uint32_t outputs = 0;    ///< Written by the module.
};

/// Bias of a line that nothing drives.
enum class GpioBias : std::uint8_t { kAsIs, kNone, kPullUp, kPullDown };

/// Lines of one GPIO chip that a module wants: all, or none is held.
struct GpioNeed {
  struct Input {
    std::string name;
    int line = 0;
    GpioBias bias = GpioBias::kAsIs;
  };
  struct Output {
    std::string name;
    int line = 0;
  };
  std::string chip;  ///< Name, path or label.
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  std::uint32_t safe_levels =
      0;  ///< Levels of the outputs when they are opened, at the end, and when ticks stop.
  std::unique_ptr<GpioImage> image;
};

}  // namespace rc10
