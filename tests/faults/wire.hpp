#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>

#include "config/robot_config.hpp"

namespace rc10::test {

/// Something that docs/safety.md promises was not so.
class Violation : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline constexpr double kUnsaid = std::numeric_limits<double>::quiet_NaN();

/// The frames of a drive as its orders. At the output shaft, direction included; effort in A at the motor,
/// or V.
struct Told {
  enum class Law : std::uint8_t {
    kOff,       ///< Switched off; or nothing was said yet.
    kEffort,    ///< `effort` alone.
    kVelocity,  ///< Its velocity loop.
    kAngle,     ///< Its angle loop.
    kSpring,    ///< Stiffness, damping and feed-forward in one sum.
    kDuty,      ///< A share of the supply voltage: `effort`, -1 to 1.
    kBrake,     ///< Resists motion, whichever way.
  };
  Law law = Law::kOff;
  double effort = 0.0;              ///< In all laws but kEffort and kDuty the feed-forward.
  double sum = 0.0;                 ///< kSpring: the effort as of the last feedback; kUnsaid: not known.
  double sum_step = 0.0;            ///< And how much of it is rounding.
  double velocity_rpm = 0.0;        ///< Beside an angle: the feed-forward.
  double ahead_deg = kUnsaid;       ///< The place to go to, seen from the last feedback.
  double ahead_step_deg = 0.0;      ///< Resolution of that place,
  double ahead_turn_deg = 0.0;      ///< which may be so many of these off; 0: it is the one.
  double most_ahead_deg = kUnsaid;  ///< kVelocity: it leads to a point that is at most so far ahead.
  bool led = false;     ///< kAngle: its drive goes the shortest way, so it may be told a nearer place.
  bool stiff = false;   ///< kSpring: with a stiffness,
  bool damped = false;  ///< with a damping.
  double most_effort = kUnsaid;  ///< The bound of the effort that was told with it.
  double most_rpm = kUnsaid;     ///< And that of the speed.
  double effort_step = 0.0;      ///< Resolution of the fields.
  double velocity_step_rpm = 0.0;

  /// It gives no torque, whatever it measures.
  [[nodiscard]] bool rests() const noexcept;
  /// It gives none but against its motion.
  [[nodiscard]] bool resistsAtMost() const noexcept;
};

/// A drive's report of itself.
struct Heard {
  double velocity_rpm = 0.0;
  double temperature_c = 0.0;
  double velocity_step_rpm = 0.0;  ///< Resolution of the speed.
  double velocity_wrap_rpm = 0.0;  ///< Its field goes round after so much; 0: it does not.
};

/// A stiffness, a damping and a torque, at the drive's own output: the MIT law of five makers.
struct MitFields {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double stiffness = 0.0;
  double damping = 0.0;
  double torque_nm = 0.0;
};

/// The frames of one drive as its maker's documents have them, both ways: a second reading of them beside
/// src/drives, of which it uses tables of models alone.
class Wire {
 public:
  explicit Wire(const MotorConfig& config);
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;
  virtual ~Wire() = default;

  /// Takes in a frame that rc10d has sent on its bus. A bit for each byte that means something to this
  /// drive; 0: it is none of its frames. Throws Violation for what rc10d must never send.
  virtual std::uint64_t said(const CanFrame& frame) = 0;
  /// It is a command to this drive of a kind that rc10d never sends.
  [[nodiscard]] virtual bool obeys(const CanFrame&) const { return false; }
  /// A data frame that makes this drive move, whoever sends it: neither rest, nor a question, nor a setting.
  [[nodiscard]] virtual bool steeredBy(const CanFrame& frame) const = 0;
  /// It changes something in this drive.
  [[nodiscard]] virtual bool changedBy(const CanFrame& frame) const { return obeys(frame); }
  /// Takes in a frame from the bus. Whether it is feedback of this drive that could be a sample.
  virtual bool heard(const CanFrame& frame) = 0;
  [[nodiscard]] virtual Told told() const = 0;
  [[nodiscard]] const Heard& measured() const noexcept { return measured_; }

  /// Each frame that heard() takes for a sample is one to rc10d.
  [[nodiscard]] virtual bool samplesAlways() const { return false; }
  /// Enabled and without a target it rests; else it may resist motion.
  [[nodiscard]] virtual bool idlesAtRest() const { return true; }
  /// Exactly one frame tells it something in each tick.
  [[nodiscard]] virtual bool toldOnceATick() const { return false; }
  /// Effort for each rpm of a damp that is an effort; kUnsaid: the drive damps by itself.
  [[nodiscard]] virtual double dampPerRpm() const { return kUnsaid; }

 protected:
  static constexpr std::uint64_t kAllBytes = ~std::uint64_t{0};

  [[nodiscard]] int id() const noexcept { return settings_.id; }
  [[nodiscard]] const MotorSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] const MotorTraits& traits() const noexcept { return traits_; }
  [[nodiscard]] double direction() const noexcept { return settings_.direction < 0 ? -1.0 : 1.0; }
  /// Turns of the drive's own output per turn of the output shaft, signed.
  [[nodiscard]] double perOutput() const noexcept { return per_output_; }
  /// Effort of a torque at the drive's own output.
  [[nodiscard]] double effortOfNm(double drive_nm) const noexcept {
    return direction() * drive_nm / static_cast<double>(traits_.torque_nm_per_a);
  }
  [[nodiscard]] double rpmOfRadPerS(double drive_rad_s) const noexcept;
  [[nodiscard]] double degOfRad(double drive_rad) const noexcept;
  /// Spring of fields with these steps, when the drive was last seen at this place, with this speed.
  [[nodiscard]] Told springOf(const MitFields& fields, const MitFields& steps, double position_rad,
                              double velocity_rad_s) const noexcept;
  [[noreturn]] void refuse(const CanFrame& frame, const char* why) const;

  Heard measured_;
  double speed_field_end_rad_s_ = 0.0;  ///< At the drive; 0: its speed is told at any.

 private:
  static constexpr double kSpeedFieldStep = 1.0 / 2048.0;  // of twelve bits, the coarsest
  MotorSettings settings_;
  MotorTraits traits_;
  double per_output_;
};

// Numbers in a payload.
[[nodiscard]] std::uint32_t bigEndian(const CanFrame& frame, std::size_t at, std::size_t bytes);
[[nodiscard]] std::uint32_t littleEndian(const CanFrame& frame, std::size_t at, std::size_t bytes);
[[nodiscard]] std::int16_t int16Of(std::uint32_t raw);
[[nodiscard]] std::int32_t int32Of(std::uint32_t raw);
[[nodiscard]] float floatOf(std::uint32_t raw);
/// `bits` from bit `first` on, counted from the first byte's highest.
[[nodiscard]] std::uint32_t bitsAt(const CanFrame& frame, std::size_t first, std::size_t bits);
/// Linear, from 0 to 2^bits - 1.
[[nodiscard]] double onScale(std::uint32_t code, double low, double high, unsigned bits);
[[nodiscard]] bool plainFrame(const CanFrame& frame, std::size_t length);
/// Bytes that are not 0.
[[nodiscard]] bool saysSomething(const CanFrame& frame);
/// A stiffness, a damping or a torque in fields of twelve bits that begin at these; half a step is none.
[[nodiscard]] bool lawOfTorque(const CanFrame& frame, std::size_t stiffness, std::size_t damping,
                               std::size_t torque);
/// The questions of a scan, as docs/rc10ctl.md has them: PING of VESC tools, type 0 of RobStride.
[[nodiscard]] bool isQuestionOfScan(const CanFrame& frame);

[[nodiscard]] std::unique_ptr<Wire> makeDjiWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeDamiaoWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeRobstrideWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeCubemarsWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeOdriveWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeVescWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeMoteusWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeLktechWire(const MotorConfig& config);
[[nodiscard]] std::unique_ptr<Wire> makeMyactuatorWire(const MotorConfig& config);
/// The one of the motor's family.
[[nodiscard]] std::unique_ptr<Wire> makeWire(const MotorConfig& config);

}  // namespace rc10::test
