#include "motor/geared_loops.hpp"

namespace rc10 {
namespace {

/// Speed in, effort out.
template <typename Velocity>
void scaleVelocityLoop(Velocity& loop, float turns) noexcept {
  loop.kp *= turns;
  loop.ki *= turns;
  loop.kd *= turns;
  loop.deadband /= turns;
}

}  // namespace

// Gains of the angle loop stay: rpm per degree, both of one shaft.
CascadeConfig loopsBehindGear(CascadeConfig loops, double turns) noexcept {
  const auto ratio = static_cast<float>(turns);
  if (auto* incremental = std::get_if<PID_Incremental::Config>(&loops.velocity)) {
    scaleVelocityLoop(*incremental, ratio);
  } else if (auto* position = std::get_if<PID_Position::Config>(&loops.velocity)) {
    scaleVelocityLoop(*position, ratio);
    position->integral_separation /= ratio;
  }
  loops.angle.deadband /= ratio;
  loops.angle.integral_separation /= ratio;
  loops.angle.integral_limit /= ratio;
  loops.angle.output_limit /= ratio;
  loops.velocity_limit_rpm /= ratio;
  return loops;
}

}  // namespace rc10
