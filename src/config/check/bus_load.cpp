#include "config/check/bus_load.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/frame_bits.hpp"

namespace rc10 {
namespace {

constexpr int kLargestDivider = 100;

/// Seconds of the bus that a frame takes.
double timeOf(FrameBits bits, const BusConfig& bus) {
  const double data_bitrate = bus.data_bitrate > 0 ? bus.data_bitrate : bus.bitrate;
  return static_cast<double>(bits.nominal) / bus.bitrate + static_cast<double>(bits.data) / data_bitrate;
}

BusLoad loadOf(const BusUse::Stream& stream, const BusConfig& bus) {
  return {stream.per_second * timeOf(unstuffedBits(stream.shape), bus),
          stream.per_second * timeOf(worstCaseBits(stream.shape), bus)};
}

BusLoad loadOf(std::span<const BusUse::Stream> streams, const BusConfig& bus) {
  BusLoad sum;
  for (const auto& stream : streams) sum = sum + loadOf(stream, bus);
  return sum;
}

/// A frame that carries the commands of several motors is one frame.
class Commands {
 public:
  [[nodiscard]] BusLoad take(const BusUse& use, const BusConfig& bus) {
    BusLoad sum;
    for (const auto& stream : use.commands) {
      const std::pair<CanId, std::string_view> shared{stream.id, use.layout};
      if (!use.layout.empty() && std::find(seen_.begin(), seen_.end(), shared) != seen_.end()) continue;
      seen_.push_back(shared);
      sum = sum + loadOf(stream, bus);
    }
    return sum;
  }

 private:
  std::vector<std::pair<CanId, std::string_view>> seen_;
};

/// Feedback that comes unasked, and everything else.
struct Parts {
  BusLoad unasked;
  BusLoad rest;
  int unasked_motors = 0;
  double unasked_per_hz = 0.0;  ///< Worst case.
};

Parts partsOf(const BusConfig& bus, int rate_hz, int least_divider) {
  Parts parts;
  Commands commands;
  for (const auto& motor : bus.motors) {
    MotorSettings settings = motor.settings;
    const MotorTraits traits = motor.traits();
    settings.tick_hz = rate_hz;
    const bool own_frames = motor.family->busUse(settings).layout.empty();
    if (own_frames) settings.command_divider = std::max(settings.command_divider, least_divider);
    if (traits.asked) settings.feedback_hz = std::max(1, rate_hz / settings.command_divider);
    const BusUse use = motor.family->busUse(settings);
    parts.rest = parts.rest + commands.take(use, bus);
    const BusLoad feedback = loadOf(use.feedback, bus);
    if (traits.asked) {
      parts.rest = parts.rest + feedback;
      continue;
    }
    parts.unasked = parts.unasked + feedback;
    ++parts.unasked_motors;
    parts.unasked_per_hz += feedback.worst_case / std::max(settings.feedback_hz, 1);
  }
  return parts;
}

}  // namespace

BusLoad operator+(const BusLoad& a, const BusLoad& b) noexcept {
  return {a.unstuffed + b.unstuffed, a.worst_case + b.worst_case};
}

BusLoad predictLoad(const BusConfig& bus, int rate_hz) {
  const Parts parts = partsOf(bus, rate_hz, 1);
  return parts.unasked + parts.rest;
}

std::vector<BusLoad> predictLoadByMotor(const BusConfig& bus, int rate_hz) {
  std::vector<BusLoad> loads;
  Commands commands;
  for (const auto& motor : bus.motors) {
    MotorSettings settings = motor.settings;
    settings.tick_hz = rate_hz;
    const BusUse use = motor.family->busUse(settings);
    loads.push_back(commands.take(use, bus) + loadOf(use.feedback, bus));
  }
  return loads;
}

int feedbackRateThatFits(const BusConfig& bus, int rate_hz) {
  const Parts parts = partsOf(bus, rate_hz, 1);
  if (parts.unasked_motors == 0 || parts.unasked_per_hz <= 0.0) return 0;
  const double room = kCrowdedLoad - parts.rest.worst_case;
  return std::max(0, static_cast<int>(std::floor(room / parts.unasked_per_hz + 1e-9)));
}

int dividerThatFits(const BusConfig& bus, int rate_hz) {
  for (int divider = 1; divider <= kLargestDivider; ++divider) {
    const Parts parts = partsOf(bus, rate_hz, divider);
    if ((parts.unasked + parts.rest).worst_case <= kCrowdedLoad) return divider;
  }
  return 0;
}

}  // namespace rc10
