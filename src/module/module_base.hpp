#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <ratio>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "bus/i_protocol.hpp"
#include "bus/serial_device.hpp"
#include "bus/serial_format.hpp"
#include "module/device_needs.hpp"
#include "module/module_robot.hpp"

namespace rc10 {

/// Signals that a module takes and gives, of each kind at most.
inline constexpr std::size_t kMaxSignals = 32;

/// Value of an input that nobody gives, and of an output that is not valid now.
inline constexpr double kNoSignal = std::numeric_limits<double>::quiet_NaN();

/// Something that a module may report.
struct ModuleEvent {
  std::string text;       ///< "jammed: reverses"
  bool expected = false;  ///< Told as information, not as a warning.
};

/// Inputs and outputs of a module, by name. Names end with their unit: "vx_m_s".
struct ModuleSignals {
  std::vector<std::string> inputs;   ///< Given by LCM, by rc10ctl or by another module.
  std::vector<std::string> outputs;  ///< Published with the robot's state.
  std::vector<ModuleEvent> events;
};

class ModuleDirectory;

/// A serial port that a module wants, and the protocol that it injects.
struct SerialNeed {
  std::string path;
  SerialFormat format;
  std::unique_ptr<I_Protocol> protocol;
};

/// A reusable part of a robot: chassis, gimbal, remote. The scheduler calls update() in every tick, before
/// the motors. Towards the motors a module is a client with a name and a priority: its targets follow the
/// rules of leases, limits and fallbacks as everybody's.
///
/// After it was built a module allocates nothing, waits for nothing and throws nothing: it belongs to the
/// scheduler thread.
class Module_Base {
 public:
  explicit Module_Base(ModuleSignals signals);
  Module_Base(const Module_Base&) = delete;
  Module_Base& operator=(const Module_Base&) = delete;
  virtual ~Module_Base() = default;

  /// One tick. Its requests to `robot` act in this tick.
  virtual void update(const Tick& tick, ModuleRobot& robot) noexcept = 0;

  /// In each tick while rc10d stops: update() is not called any more.
  virtual void rest(const Tick& /*tick*/) noexcept {}

  /// Once, when all modules are built: finds those that it sends to. The error begins with a key.
  [[nodiscard]] virtual Result<void> connect(const ModuleDirectory& others);

  /// Once, when it is built: the serial port that it wants; empty: none. It may keep a pointer to the
  /// protocol, which lives as long as the module.
  [[nodiscard]] virtual std::optional<SerialNeed> takeSerialNeed() { return std::nullopt; }
  /// Once, when that port is built: for a module that sends. It lives as long as the module's updates.
  virtual void useSerial(SerialDevice& /*device*/) noexcept {}
  /// The same for an SPI device, and for lines of a GPIO chip: the module may keep a pointer to the output or
  /// the image.
  [[nodiscard]] virtual std::optional<SpiNeed> takeSpiNeed() { return std::nullopt; }
  [[nodiscard]] virtual std::optional<GpioNeed> takeGpioNeed() { return std::nullopt; }

  [[nodiscard]] const ModuleSignals& signals() const noexcept { return signals_; }

  /// Present values of the inputs, for the scheduler and for tests. NaN: not given.
  void setInputs(std::span<const double> values) noexcept;
  /// Before setInputs(): who gives them from now on is another than before.
  void changeSender() noexcept { ++sender_; }
  void clearInputs() noexcept;
  [[nodiscard]] std::span<const double> outputs() const noexcept { return outputs_; }

 protected:
  /// NaN: not given. Inputs are given together: a message replaces all of them until its validity ends.
  [[nodiscard]] double input(std::size_t index) const noexcept { return inputs_[index]; }
  /// Changes when somebody else gives the inputs: what one has counted is nothing to another.
  [[nodiscard]] std::uint32_t senderCount() const noexcept { return sender_; }
  /// Whether somebody commands this module now.
  [[nodiscard]] bool commanded() const noexcept { return commanded_; }
  void setOutput(std::size_t index, double value) noexcept { outputs_[index] = value; }
  /// In ms. Duration::max(): never heard, no signal.
  void setAge(std::size_t index, Duration age) noexcept {
    setOutput(index,
              age == Duration::max() ? kNoSignal : std::chrono::duration<double, std::milli>(age).count());
  }

 private:
  ModuleSignals signals_;
  std::vector<double> inputs_;
  std::vector<double> outputs_;
  bool commanded_ = false;
  std::uint32_t sender_ = 0;
};

/// All modules of a robot, by name.
class ModuleDirectory {
 public:
  struct Entry {
    std::string_view name;
    const Module_Base* module = nullptr;
  };
  explicit ModuleDirectory(std::vector<Entry> entries) : entries_(std::move(entries)) {}

  /// The input that "module.input" names. The error says what there is.
  [[nodiscard]] Result<SignalPlace> findInput(std::string_view name) const {
    return find(name, &ModuleSignals::inputs, "input");
  }
  /// The output that "module.output" names.
  [[nodiscard]] Result<SignalPlace> findOutput(std::string_view name) const {
    return find(name, &ModuleSignals::outputs, "output");
  }

 private:
  [[nodiscard]] Result<SignalPlace> find(std::string_view name, std::vector<std::string> ModuleSignals::*kind,
                                         const std::string& what) const;

  std::vector<Entry> entries_;
};

}  // namespace rc10
