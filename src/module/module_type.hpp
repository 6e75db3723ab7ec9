#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "app/target.hpp"
#include "app/time.hpp"
#include "module/module_base.hpp"
#include "motor/own_key.hpp"
#include "motor/own_values.hpp"

namespace rc10 {

/// Names in keys that name an input or an output of another module.
inline constexpr std::string_view kSignalPattern = "[a-z0-9_]{1,31}\\.[a-z0-9_]{1,31}";
inline constexpr std::string_view kSignalWords = "MODULE.SIGNAL, for example imu.yaw_deg";

/// Robot, as a module may know it before it runs.
struct RobotOutline {
  struct Motor {
    std::string name;
    ModeSet modes;
    float velocity_limit_rpm = 0.0F;  ///< Its limit, or its no-load speed; 0: not known.
    float current_limit_a = 0.0F;     ///< 0: not known, or its effort is no current.
    double angle_min_deg = 0.0;       ///< Its soft limits; infinite: none.
    double angle_max_deg = 0.0;
    Duration current_period{};  ///< Period of the current that its drive reports.
    /// See MotorTraits; empty: it reports its current, its torque.
    std::string_view unreported_current_remedy{};
    std::string_view unreported_torque_remedy{};
  };
  std::vector<Motor> motors;
  int tick_hz = 1000;

  /// An error that begins with `key` unless the motor can be told such targets.
  [[nodiscard]] Result<void> require(ControlMode mode, std::size_t motor, std::string_view key) const;
};

/// One module as configured.
struct ModuleSettings {
  std::string name;
  int priority = 0;  ///< Priority of its targets and of what it sends.
  OwnValues own;     ///< Values of the type's keys; motors and modules as their places.
};

/// A type of module, as written under `type`: all that the rest of the program needs to know of it.
/// Stateless, and constant after start. Start-up only: it allocates.
class ModuleType {
 public:
  ModuleType() = default;
  ModuleType(const ModuleType&) = delete;
  ModuleType& operator=(const ModuleType&) = delete;
  virtual ~ModuleType() = default;

  /// "mecanum_chassis"
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// One sentence, for people.
  [[nodiscard]] virtual std::string_view about() const noexcept = 0;
  [[nodiscard]] virtual std::span<const OwnKey> keys() const noexcept = 0;
  /// Whether it finds the angle of this motor once that is enabled.
  [[nodiscard]] virtual bool homes(const ModuleSettings& /*settings*/, std::size_t /*motor*/) const {
    return false;
  }
  /// Dependence of the motors that its keys name: they are a group, whether the robot declares one
  /// or not.
  enum class Coupling : std::uint8_t {
    kNone,
    kStop,      ///< They stop together.
    kTogether,  ///< They are enabled together, too: mechanically they are one.
  };
  [[nodiscard]] virtual Coupling coupling() const noexcept { return Coupling::kNone; }
  /// `settings.own` has all of keys(), each in its range. The error begins with the key that is wrong:
  /// "wheel_radius_m: ...".
  [[nodiscard]] virtual Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                                   const RobotOutline& robot) const = 0;
};

}  // namespace rc10
