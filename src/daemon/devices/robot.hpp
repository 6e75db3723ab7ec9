#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "bus/can_link_settings.hpp"
#include "bus/can_socket.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/serial_device.hpp"
#include "config/robot_config.hpp"
#include "daemon/devices/line_bank.hpp"
#include "daemon/devices/serial_channel.hpp"
#include "daemon/devices/spi_channel.hpp"
#include "module/module_base.hpp"
#include "motor/motor_family.hpp"
#include "sim/sim_port.hpp"

namespace rc10 {

/// The buses, motors and groups that a configuration describes, registered with each other.
/// Built by the main thread; from the first tick on it belongs to the scheduler thread.
class Robot {
 public:
  /// Opens every bus. A simulated bus is one end of a socket pair; the other end is in simPorts().
  [[nodiscard]] static Result<std::unique_ptr<Robot>> build(const RobotConfig& config);

  struct MotorEntry {
    std::unique_ptr<Motor_Base> motor;
    std::size_t bus = 0;
    Duration feedback_timeout{};
    Duration oldest_heard{};  ///< Age of a sample, when it comes, up to which its motor is heard.
    /// It is lost when feedback_timeout is over and it was unheard for more than this, in which a pause of
    /// rc10d counts as two periods.
    Duration most_unheard{};
    /// Unheard for so long by the same count, it may have been restarted: it is lost, though it is heard
    /// again.
    Duration restart_unheard = Duration::max();
    GuardConfig guard{};
    RestConfig rest{};
    ShapingConfig shaping{};
    ReducedConfig reduced{};
    FallbackConfig fallback{};
    float standstill_rpm = 0.0F;
    Duration run_down{};                ///< Without torque and feedback it turns no longer than this.
    bool divided = false;               ///< Ticks may tell its drive nothing: Motor_Base::due() says which.
    bool optional = false;              ///< The robot may be enabled without it.
    bool homed = false;                 ///< A module finds its angle.
    int id = 0;                         ///< As set on the drive.
    std::vector<FrameFilter> steers{};  ///< Frames that command its drive, whoever sends them.
    std::vector<FrameFilter> obeys{};   ///< All that it takes, in fewer filters: those lie within.
  };
  struct BusEntry {
    std::unique_ptr<fdCANbus> bus;
    std::string interface {};  ///< Empty: simulated.
    CanSocketOptions options{};
    bool feedback_expected = false;     ///< Some motor talks without being asked.
    UniqueFd echo{};                    ///< Sees the transmit echo; empty where there is none.
    std::vector<CanId> watched{};       ///< The command ids whose echoes are watched.
    CanLinkSettings settings{};         ///< As configured; of a simulated bus empty.
    bool manage_link = false;           ///< rc10d applies them and restarts the interface.
    std::unique_ptr<BusParts> parts{};  ///< The packers that several motors share.
    ForeignLimit foreign{};
    bool held = false;       ///< The bus carries no frames now. Scheduler thread only.
    bool simulated = false;  ///< Its drives are a thread of this process.
  };

  struct ModuleEntry {
    std::string name;
    int priority = 0;
    std::unique_ptr<Module_Base> module;
  };
  struct SerialEntry {
    std::unique_ptr<SerialDevice> device;
    std::size_t channel = 0;  ///< In serialChannels().
  };

  struct SpiEntry {
    std::unique_ptr<SpiOutput> output;
    std::size_t channel = 0;        ///< In spiChannels().
    std::uint32_t handed_over = 0;  ///< Frames. Scheduler thread only.
  };
  struct GpioEntry {
    std::unique_ptr<GpioImage> image;
    std::size_t bank = 0;  ///< In lineBanks().
  };

  [[nodiscard]] std::vector<MotorEntry>& motors() noexcept { return motors_; }
  [[nodiscard]] const std::vector<MotorEntry>& motors() const noexcept { return motors_; }
  [[nodiscard]] std::vector<BusEntry>& buses() noexcept { return buses_; }
  [[nodiscard]] const std::vector<BusEntry>& buses() const noexcept { return buses_; }
  [[nodiscard]] std::vector<ModuleEntry>& modules() noexcept { return modules_; }
  [[nodiscard]] const std::vector<ModuleEntry>& modules() const noexcept { return modules_; }
  [[nodiscard]] std::vector<SerialEntry>& serialDevices() noexcept { return serial_devices_; }
  /// Null: no module wants a serial port.
  [[nodiscard]] SerialChannels* serialChannels() noexcept { return serial_channels_.get(); }
  [[nodiscard]] std::vector<SpiEntry>& spiOutputs() noexcept { return spi_outputs_; }
  [[nodiscard]] std::vector<std::unique_ptr<SpiChannel>>& spiChannels() noexcept { return spi_channels_; }
  [[nodiscard]] std::vector<GpioEntry>& gpioImages() noexcept { return gpio_images_; }
  /// Null: no module wants GPIO lines.
  [[nodiscard]] LineBanks* lineBanks() noexcept { return line_banks_.get(); }
  [[nodiscard]] const std::vector<GroupConfig>& groups() const noexcept { return coupled_; }
  /// Between two ticks.
  [[nodiscard]] Duration period() const noexcept { return period_; }
  [[nodiscard]] UnrestPolicy unrestPolicy() const noexcept { return unrest_; }
  /// The simulated motors, for the thread or the test that steps them.
  [[nodiscard]] std::vector<std::unique_ptr<sim::SimPort>>& simPorts() noexcept { return sim_ports_; }
  /// The thread of the simulation counts its steps here; 0: somebody else steps it. Any thread.
  [[nodiscard]] std::atomic<std::uint64_t>& simulationSteps() noexcept { return simulation_steps_; }

 private:
  Robot() = default;

  [[nodiscard]] Result<void> addSocketCan(const BusConfig& config);
  [[nodiscard]] Result<void> addSimulated(const BusConfig& config);
  /// To the bus that was added last.
  [[nodiscard]] Result<void> addMotors(const BusConfig& config);
  [[nodiscard]] Result<void> addMotor(const MotorConfig& config, std::size_t bus_index);
  [[nodiscard]] static Duration restartUnheard(const MotorConfig& config, const Motor_Base& motor);
  [[nodiscard]] Result<void> addModules(const RobotConfig& config);
  [[nodiscard]] Result<void> addSerialPorts();
  void addSpiDevices();
  [[nodiscard]] Result<void> addGpioLines();

  Duration period_{};
  UnrestPolicy unrest_ = UnrestPolicy::kGroup;
  std::atomic<std::uint64_t> simulation_steps_{0};
  std::vector<BusEntry> buses_;
  std::vector<MotorEntry> motors_;
  std::vector<GroupConfig> coupled_;
  std::unique_ptr<SerialChannels> serial_channels_;  // longer than the devices, which push to them
  std::vector<SerialEntry> serial_devices_;  // and these longer than the modules that read their protocols
  std::vector<std::unique_ptr<SpiChannel>> spi_channels_;
  std::vector<SpiEntry> spi_outputs_;
  std::unique_ptr<LineBanks> line_banks_;
  std::vector<GpioEntry> gpio_images_;
  std::vector<ModuleEntry> modules_;
  std::vector<std::unique_ptr<sim::SimPort>> sim_ports_;
};

}  // namespace rc10
