#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "motor/bus_parts.hpp"
#include "motor/bus_use.hpp"
#include "motor/id_conflict.hpp"
#include "motor/key_bound.hpp"
#include "motor/motor_base.hpp"
#include "motor/motor_settings.hpp"
#include "motor/motor_traits.hpp"
#include "motor/own_key.hpp"

namespace rc10 {

/// One family of drives: all that the rest of the program needs to know of it. Stateless, and constant
/// after start. Start-up only: it allocates.
class MotorFamily {
 public:
  MotorFamily() = default;
  MotorFamily(const MotorFamily&) = delete;
  MotorFamily& operator=(const MotorFamily&) = delete;
  virtual ~MotorFamily() = default;

  /// "DJI", for messages and docs.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// As written in the configuration; no two families share one.
  [[nodiscard]] virtual std::span<const std::string_view> models() const noexcept = 0;
  [[nodiscard]] virtual std::span<const OwnKey> keys() const noexcept { return {}; }
  /// `model` is one of models(); `own` has all of keys().
  [[nodiscard]] virtual MotorTraits traits(std::string_view model, const OwnValues& own) const = 0;
  /// Conditions beyond the ranges of single keys. The error begins with the key: "master_id: ...".
  [[nodiscard]] virtual Result<void> check(const MotorSettings& settings) const;
  /// The only bit rate that its drives know; 0: any.
  [[nodiscard]] virtual int bitrate() const noexcept { return 0; }
  /// Judge of the ids of its motors on one bus, with remedies of its own; null: they are compared by
  /// busUse().
  [[nodiscard]] virtual IdJudge idJudge() const noexcept { return nullptr; }
  /// Bounds of single keys for a model, in the schema only; check() and traits() state theirs themselves.
  [[nodiscard]] virtual std::vector<KeyBound> keyBounds(std::string_view /*model*/) const { return {}; }
  /// `settings` has passed check().
  [[nodiscard]] virtual BusUse busUse(const MotorSettings& settings) const = 0;
  /// Builds the motor and registers its halves with the bus. The error names the motor.
  [[nodiscard]] virtual Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                                  BusParts& parts) const = 0;
};

}  // namespace rc10
