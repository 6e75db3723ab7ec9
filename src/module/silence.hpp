#pragma once

#include <cstddef>

#include "module/module_robot.hpp"

namespace rc10 {

/// Source of values that may fall silent. Reports it once, and once that the source is back; nothing before
/// it was heard first.
class Silence {
 public:
  Silence(std::size_t silent_event, std::size_t back_event) noexcept
      : silent_event_(silent_event), back_event_(back_event) {}

  /// One tick. `fresh`: its values are not too old.
  void watch(bool fresh, ModuleRobot& robot) noexcept {
    const bool was_silent = silent_;
    heard_ = heard_ || fresh;
    silent_ = heard_ && !fresh;
    if (silent_ != was_silent) robot.report(silent_ ? silent_event_ : back_event_);
  }

 private:
  std::size_t silent_event_;
  std::size_t back_event_;
  bool heard_ = false;
  bool silent_ = false;
};

}  // namespace rc10
