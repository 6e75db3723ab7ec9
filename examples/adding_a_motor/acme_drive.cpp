#include "acme_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "acme_motor.hpp"
#include "bus/byte_order.hpp"
#include "sim/servo_drive.hpp"

namespace acme {
namespace {

using namespace rc10;

constexpr Duration kWatchdog = std::chrono::milliseconds{100};

class AcmeDrive final : public sim::ServoDrive {
 public:
  AcmeDrive(const MotorSettings& settings, const MotorTraits& traits, const BusUse& use,
            const sim::MotorLoad& load)
      : ServoDrive(settings, traits, load, use.sends),
        command_(use.obeys.front().id),
        gear_(traits.gear_ratio) {}

  void receive(const CanFrame& frame) noexcept override {
    if (frame.id != command_ || frame.type != FrameType::kData || frame.length != 8) return;
    last_command_ = elapsed();
    const auto bytes = frame.payload();
    mode_ = bytes[0];
    if (mode_ == 3) fault_ = 0;
    const double current_a = readLittleEndian<std::int16_t>(bytes, 2) * 0.001;
    const double rotor_rpm = readLittleEndian<std::int16_t>(bytes, 4) * 0.1;
    if (mode_ == 0 || mode_ == 3 || fault_ != 0) return release();
    mode_ == 1 ? current(current_a) : velocity(rotor_rpm / gear_);
  }

  void step(Duration dt) noexcept override {
    if (elapsed() - last_command_ > kWatchdog) restart();
    ServoDrive::step(dt);
  }

  [[nodiscard]] Duration feedbackPeriod() const noexcept override { return std::chrono::milliseconds{5}; }

  [[nodiscard]] std::size_t feedback(std::span<CanFrame> out) noexcept override {
    std::array<std::uint8_t, 8> bytes{};
    writeLittleEndian(bytes, 0, static_cast<std::int32_t>(std::lround(driveAngleDeg() * gear_ / 0.01)));
    writeLittleEndian(bytes, 4, static_cast<std::int16_t>(std::lround(rotorRpm() / 0.1)));
    bytes[6] = static_cast<std::uint8_t>(std::clamp(physics().temperatureC(), 0.0, 255.0));
    const bool enabled = (mode_ == 1 || mode_ == 2) && fault_ == 0;
    bytes[7] = static_cast<std::uint8_t>((enabled ? 1U : 0U) | fault_ << 1U);
    out[0] = makeClassicFrame(sends().front().id, bytes);
    return 1;
  }

  void restart() noexcept override {
    mode_ = 0;
    release();
  }
  void fault(std::uint32_t native_code) noexcept override {
    fault_ = native_code & 3U;
    release();
  }

 private:
  CanId command_;
  double gear_;
  std::uint8_t mode_ = 0;
  std::uint32_t fault_ = 0;
  Duration last_command_{};
};

}  // namespace

std::unique_ptr<sim::Drive> makeAcmeDrive(const MotorSettings& settings, const sim::MotorLoad& load) {
  const MotorFamily& family = acmeFamily();
  return std::make_unique<AcmeDrive>(settings, family.traits(settings.model, settings.own),
                                     family.busUse(settings), load);
}

}  // namespace acme
