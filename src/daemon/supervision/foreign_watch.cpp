#include "daemon/supervision/foreign_watch.hpp"

#include <utility>

#include "bus/frame_listener.hpp"
#include "daemon/exchange/events.hpp"

namespace rc10 {

ForeignWatch::ForeignWatch(Robot& robot) : robot_(robot), watched_(robot.motors().size()) {
  for (auto& entry : robot.buses()) entry.bus->setForeignListener(*this);
}

void ForeignWatch::onForeign(const fdCANbus& bus, const CanFrame& frame) noexcept {
  // The few ids first: most frames of strangers are for nobody here, and a VESC has 64 that steer it.
  const auto steered = [&frame](const Robot::MotorEntry& entry) {
    return acceptsAny(entry.obeys, frame) && acceptsAny(entry.steers, frame);
  };
  for (std::size_t motor = 0; motor < watched_.size(); ++motor) {
    const auto& entry = robot_.motors()[motor];
    const auto& on = robot_.buses()[entry.bus];
    if (on.bus.get() != &bus || on.foreign.frames == 0 || !steered(entry)) continue;
    if (bus.isRest(frame)) return;
    count(motor, on.foreign, frame);
  }
}

void ForeignWatch::count(std::size_t motor, const ForeignLimit& limit, const CanFrame& frame) noexcept {
  auto& watched = watched_[motor];
  const auto frames = static_cast<std::size_t>(limit.frames);
  watched.received[watched.count % frames] = frame.received;
  const bool enough = ++watched.count >= frames;
  // The ring's next slot holds the oldest of the last `frames` times.
  const auto& first = watched.received[watched.count % frames];
  if (enough && frame.received - first <= limit.within)
    watched.takeover = foreignFrame(frame.id, frame.sent_here);
}

std::optional<std::int32_t> ForeignWatch::takeover(std::size_t motor) noexcept {
  auto& watched = watched_[motor];
  if (!watched.takeover) return std::nullopt;
  watched.count = 0;
  return std::exchange(watched.takeover, std::nullopt);
}

}  // namespace rc10
