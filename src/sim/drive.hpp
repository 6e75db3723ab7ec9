#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "bus/frame_listener.hpp"
#include "sim/motor_physics.hpp"
#include "sim/sim_config.hpp"

namespace rc10::sim {

/// One simulated drive with its motor: takes the real command frames and gives the real feedback frames.
/// Nothing allocates after construction.
class Drive {
 public:
  /// The most frames one drive gives out at a time.
  static constexpr std::size_t kMaxFrames = 8;

  Drive() = default;
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;
  virtual ~Drive() = default;

  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
  /// Every frame that it may send.
  [[nodiscard]] virtual std::span<const FrameFilter> sends() const noexcept = 0;
  /// A frame that some node put on the bus. Its answer, if it has one, is part of the next answers().
  virtual void receive(const CanFrame& frame) noexcept = 0;
  virtual void step(Duration dt) noexcept = 0;

  /// The spacing of what it sends without being asked; 0: nothing.
  [[nodiscard]] virtual Duration feedbackPeriod() const noexcept = 0;
  /// Frames that it sends unasked at this moment. Returns how many were written to `out`.
  [[nodiscard]] virtual std::size_t feedback(std::span<CanFrame> out) noexcept = 0;
  /// The answers to what it received since the last call.
  [[nodiscard]] virtual std::size_t answers(std::span<CanFrame> /*out*/) noexcept { return 0; }

  [[nodiscard]] virtual MotorPhysics& physics() noexcept = 0;
  [[nodiscard]] virtual const MotorPhysics& physics() const noexcept = 0;
  [[nodiscard]] virtual const MotorLoad& load() const noexcept = 0;
  /// Another load from now on. Where the motor is stays as it is: initial_angle_deg has no effect.
  virtual void setLoad(const MotorLoad& load) noexcept = 0;

  /// Encoder error from now on.
  struct EncoderFault {
    bool frozen = false;    ///< The drive repeats its last frame for ever.
    bool reversed = false;  ///< Counts and speed of the opposite sign.
    double slip_turns = 0;  ///< The magnet has slipped on the rotor by so much.
  };
  /// Families without it ignore it.
  virtual void setEncoderFault(const EncoderFault& /*fault*/) noexcept {}

  /// As if its power had been away for a moment: disabled, watchdog and modes as after power-up. The motor
  /// turns on. Families that cannot tell ignore it.
  virtual void restart() noexcept {}
  /// A fault of the family's own code, latched until cleared as the real drive does; 0 ends it. Families
  /// that report none ignore it.
  virtual void fault(std::uint32_t /*native_code*/) noexcept {}
};

/// The load of the shaft, beside friction and own inertia, which have defaults of the model.
void hang(const MotorLoad& load, MotorParameters& parameters) noexcept;

/// Plausibility of a load. The error names the motor.
[[nodiscard]] Result<void> checkLoad(const std::string& name, const MotorLoad& load);

}  // namespace rc10::sim
