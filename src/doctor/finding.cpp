#include "doctor/finding.hpp"

#include <algorithm>
#include <utility>

namespace rc10::doctor {

const char* word(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kPass: return "pass";
    case Verdict::kWarn: return "warn";
    case Verdict::kFail: return "fail";
  }
  return "unknown";
}

Finding pass(std::string what, std::string why) {
  return {Verdict::kPass, std::move(what), std::move(why), {}};
}

Finding warn(std::string what, std::string why, std::string fix) {
  return {Verdict::kWarn, std::move(what), std::move(why), std::move(fix)};
}

Finding fault(std::string what, std::string why, std::string fix) {
  return {Verdict::kFail, std::move(what), std::move(why), std::move(fix)};
}

Verdict worst(const Findings& findings) noexcept {
  Verdict verdict = Verdict::kPass;
  for (const auto& finding : findings) verdict = std::max(verdict, finding.verdict);
  return verdict;
}

}  // namespace rc10::doctor
