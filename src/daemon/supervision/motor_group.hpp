#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/time.hpp"
#include "config/robot_config.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/supervision/axis.hpp"
#include "daemon/supervision/states.hpp"

namespace rc10 {

/// Motors that stop together. After Supervisor::decide() none is on while a required one is missing.
struct MotorGroup {
  MotorGroup(const GroupConfig& config, const Robot& robot);

  /// Members that are ENABLING or ACTIVE.
  [[nodiscard]] MotorSet on(const std::vector<Axis>& axes) const noexcept;
  /// Required members that are OFFLINE or in FAULT.
  [[nodiscard]] MotorSet missing(const std::vector<Axis>& axes) const noexcept;
  /// Members that are READY and held since their disable.
  [[nodiscard]] MotorSet held(const std::vector<Axis>& axes) const noexcept;
  /// Members of without_place that are still ACTIVE and have no reference.
  [[nodiscard]] MotorSet withoutPlace(const std::vector<Axis>& axes) const noexcept;
  /// It acts together, and not all of it is ACTIVE.
  [[nodiscard]] bool waits(const std::vector<Axis>& axes) const noexcept;
  /// A member was ENABLING or ACTIVE before `event`, and is not now.
  void noteLeaving(std::size_t motor, MotorStatus before, MotorEvent event) noexcept;
  /// Whether this request, for a READY member, is the first that names one that rests for the others' sake.
  [[nodiscard]] bool isFirstDisable(std::size_t motor, const Order& order) const noexcept;
  /// After each member that it names.
  void takeDisable(std::size_t motor, const Order& order) noexcept;
  /// The end of its tick.
  void forgetLeaving() noexcept;

  std::vector<std::size_t> motors;
  MotorSet required;      ///< Without the optional ones: nothing stops or waits for those.
  bool together = false;  ///< Enabled all or none, and obeying only when all do.
  GroupConfig::Return on_return = GroupConfig::Return::kRequest;
  // In this tick.
  MotorSet dropped;                  ///< Members that were ACTIVE and have been lost.
  MotorSet disabled;                 ///< Required members that were on and have been disabled,
  MotorSet refused;                  ///< or whose drives have refused.
  bool disable_asked = false;        ///< A request named some member.
  bool disabled_on_request = false;  ///< Some of `disabled` by one that somebody asked for.
  /// Request that named some of rests_with_it, where the group acts together.
  std::optional<std::uint64_t> first_disable;
  MotorSet lost_place;  ///< Required members that followed a place and have lost their reference.
  MotorSet left;        ///< Members that were on and have been disabled.
  std::optional<std::uint64_t>
      let_go;  ///< Request that let go of those that rested already: once, by all it names.
  // Until a request changes it.
  MotorSet rests_with_it;  ///< Disabled since another member was.
  MotorSet rearm;          ///< To be enabled again by itself; empty: none.
  // From tick to tick.
  MotorSet gone;            ///< missing() of the last tick.
  MotorSet without_place;   ///< lost_place, until each has a reference again: no member follows a place.
  MonotonicTime stopped{};  ///< Last time at which it was.
  MonotonicTime moved{};    ///< Last time at which a member moved or was missing.
};

}  // namespace rc10
