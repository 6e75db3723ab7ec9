#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// Checks of `rc10ctl doctor`: whether this computer can run a robot well. Each check is a function of
/// facts; each fact is read from the files of the kernel below a root that a test chooses, or handed in.
namespace rc10::doctor {

enum class Verdict : std::uint8_t {
  kPass,
  kWarn,  ///< The robot works, but worse or with less margin than it could.
  kFail,  ///< The robot will not work, or not safely.
};

/// "pass", "warn", "fail"
[[nodiscard]] const char* word(Verdict verdict) noexcept;

/// Result of one check.
struct Finding {
  Verdict verdict = Verdict::kPass;
  std::string what;  ///< Subject: "can0 bit rate".
  std::string why;   ///< Fact and its meaning.
  std::string fix;   ///< The command that mends it; empty for kPass.
};

using Findings = std::vector<Finding>;

[[nodiscard]] Finding pass(std::string what, std::string why);
[[nodiscard]] Finding warn(std::string what, std::string why, std::string fix);
[[nodiscard]] Finding fault(std::string what, std::string why, std::string fix);

/// The worst of all; kPass of none.
[[nodiscard]] Verdict worst(const Findings& findings) noexcept;

}  // namespace rc10::doctor
