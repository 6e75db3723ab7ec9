// Whatever stands in a configuration file, loading it ends, and ends with either a robot that a motor layer
// accepts or at least one reason.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "config/load_config.hpp"
#include "config/report/report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  const auto outcome = rc10::parseRobotConfig(text, "fuzz.yaml");
  if (outcome.config.has_value() != outcome.errors.empty()) std::abort();
  for (const auto& problem : outcome.errors) {
    if (problem.text.empty()) std::abort();
  }
  if (outcome && rc10::describe(*outcome.config).empty()) std::abort();
  return 0;
}
