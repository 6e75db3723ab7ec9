#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/pid_incremental.hpp"
#include "app/pid_position.hpp"
#include "app/result.hpp"

namespace rc10 {

/// The parameters of one controller of the users' STM32 library, as its firmware writes them.
struct Stm32Pid {
  double kp = 0.0;
  double ki = 0.0;
  double kd = 0.0;
  double integral_limit = 0.0;
  bool limits_integral = false;
  double output_limit = 0.0;  ///< 0: its output is always 0.
  double deadband = 0.0;
};

/// From the numbers of the firmware's initialiser, in its order: kp, ki, kd, I_Outlimit, isIOutlimit,
/// output_limit, deadband. Three at least.
/// A number as C++ writes it, from 0 on: 18.0f.
[[nodiscard]] Result<double> stm32Number(const std::string& text);

[[nodiscard]] Result<Stm32Pid> stm32Pid(std::span<const std::string> numbers);

/// The controller that does the same here, and what does not carry over, in words.
template <typename Config>
struct Converted {
  Config config;
  std::vector<std::string> notes;
};

/// The speed loop, PID_Incremental: rpm at the output in, mA out, gains of one tick.
[[nodiscard]] Converted<PID_Incremental::Config> convertSpeedGains(const Stm32Pid& pid, double td_ratio,
                                                                   double tick_s);

/// The angle loop, PID_Position: deg in, rpm out, gains per second already. `separation`: its
/// I_SeparaThreshold.
[[nodiscard]] Converted<PID_Position::Config> convertAngleGains(const Stm32Pid& pid, double separation_deg);

/// The same by the keys of a motor in the robot's configuration.
struct ConvertedGains {
  struct Gain {
    std::string_view key;
    float value = 0.0F;
    std::string_view comment;
  };
  std::string section;  ///< "velocity_pid"
  std::string type;     ///< Type of the controller; empty: there is one only.
  std::vector<Gain> gains;
  float current_limit_a = 0.0F;  ///< Beside the section; 0: none.
  std::vector<std::string> notes;
};

[[nodiscard]] ConvertedGains namedGains(const Converted<PID_Incremental::Config>& speed);
[[nodiscard]] ConvertedGains namedGains(const Converted<PID_Position::Config>& angle);

/// Lines for a motor in the robot's configuration; the notes as comments.
[[nodiscard]] std::string yamlLines(const ConvertedGains& gains);

}  // namespace rc10
