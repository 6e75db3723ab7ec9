#pragma once

#include <optional>

#include "app/time.hpp"
#include "daemon/exchange/safety_contact.hpp"

namespace rc10 {

/// A normally closed contact. The gpio thread's only.
class ContactInput {
 public:
  ContactInput() = default;
  ContactInput(const ContactInput&) = delete;
  ContactInput& operator=(const ContactInput&) = delete;
  virtual ~ContactInput() = default;

  /// State of the contact after a change, or after `timeout`; at once where the chip has no interrupts. kOpen
  /// also if it opened since the last call and is closed again.
  [[nodiscard]] virtual ContactState wait(Duration timeout) noexcept = 0;
};

/// A digital output. Of one thread only: gpio or lines.
class DigitalOutput {
 public:
  DigitalOutput() = default;
  DigitalOutput(const DigitalOutput&) = delete;
  DigitalOutput& operator=(const DigitalOutput&) = delete;
  virtual ~DigitalOutput() = default;

  /// False: the chip refused.
  [[nodiscard]] virtual bool set(bool high) noexcept = 0;
};

/// A digital input that is looked at. The lines thread's only.
class DigitalInput {
 public:
  DigitalInput() = default;
  DigitalInput(const DigitalInput&) = delete;
  DigitalInput& operator=(const DigitalInput&) = delete;
  virtual ~DigitalInput() = default;

  /// Whether the line is high. Empty: the chip refused.
  [[nodiscard]] virtual std::optional<bool> high() noexcept = 0;
};

}  // namespace rc10
