#include "module/imu.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "app/angle.hpp"
#include "app/units.hpp"
#include "module/hipnuc_protocol.hpp"
#include "module/serial_keys.hpp"
#include "module/silence.hpp"
#include "module/witmotion_protocol.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

constexpr std::array<std::string_view, 3> kImuProtocols{"witmotion", "hipnuc", "inputs"};

constexpr OwnKey optionalPort() {
  OwnKey key = kPortKey;
  key.required = false;
  return key;
}

constexpr std::array kImuKeys{
    OwnKey{.name = "protocol",
           .kind = kChoice,
           .choices = kImuProtocols,
           .required = true,
           .about = "witmotion or hipnuc on a serial port; inputs: another program gives the values."},
    optionalPort(), baudKey("Baud rate, as set on the sensor. WitMotion leaves the factory with 9600."),
    OwnKey{.name = "max_age_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 5,
           .max = 5000,
           .default_text = "50",
           .about = "Older values mean nothing: the outputs are NaN. With inputs the validity of the message "
                    "counts instead."},
    OwnKey{.name = "yaw_offset_deg",
           .kind = kNumber,
           .unit = "deg",
           .min = -360,
           .max = 360,
           .default_text = "0",
           .about = "Added to the yaw."}};

// The inputs, and the first outputs.
enum Axis : std::size_t { kYaw, kPitch, kRoll, kYawRate, kPitchRate, kRollRate, kAccX, kAccY, kAccZ, kAxes };
constexpr std::size_t kAgeMs = kAxes;

ModuleSignals imuSignals(bool by_inputs) {
  const std::vector<std::string> axes{"yaw_deg",
                                      "pitch_deg",
                                      "roll_deg",
                                      "yaw_rate_deg_s",
                                      "pitch_rate_deg_s",
                                      "roll_rate_deg_s",
                                      "acceleration_x_m_s2",
                                      "acceleration_y_m_s2",
                                      "acceleration_z_m_s2"};
  ModuleSignals signals;
  if (by_inputs) signals.inputs = axes;
  signals.outputs = axes;
  signals.outputs.emplace_back("age_ms");
  signals.events = {
      {.text = "the sensor is silent: its values mean nothing; see its power, wire and baud rate"},
      {.text = "the sensor is back", .expected = true}};
  return signals;
}

std::unique_ptr<ImuProtocol> makeProtocol(const std::string& name) {
  if (name == "witmotion") return std::make_unique<WitMotionProtocol>();
  if (name == "hipnuc") return std::make_unique<HipnucProtocol>();
  return nullptr;
}

class Imu : public Module_Base {
 public:
  explicit Imu(const OwnValues& own)
      : Module_Base(imuSignals(own.text("protocol") == "inputs")),
        path_(own.text("port")),
        format_({.baud = own.integer("baud")}),
        max_age_(std::chrono::milliseconds{own.integer("max_age_ms")}),
        yaw_offset_deg_(own.number("yaw_offset_deg")),
        owned_(makeProtocol(own.text("protocol"))),
        protocol_(owned_.get()) {}

  [[nodiscard]] std::optional<SerialNeed> takeSerialNeed() override {
    if (owned_ == nullptr) return std::nullopt;
    return SerialNeed{.path = path_, .format = format_, .protocol = std::move(owned_)};
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    std::array<double, kAxes> values{};
    values.fill(kNoSignal);
    const Duration age = protocol_ != nullptr ? readStream(values, tick) : readInputs(values);
    values[kYaw] = wrapHalfTurn(values[kYaw] + yaw_offset_deg_);
    const bool fresh = age <= max_age_;
    silence_.watch(fresh, robot);
    for (std::size_t i = 0; i < kAxes; ++i) setOutput(i, fresh ? values[i] : kNoSignal);
    setAge(kAgeMs, age);
  }

 private:
  enum EventPlace : std::size_t { kSilent, kBack };

  // NaN: not sent by the sensor. The age is that of the oldest value.
  Duration readStream(std::array<double, kAxes>& values, const Tick& tick) const noexcept {
    Duration oldest{};
    const auto take = [&](const auto& stamped, auto put) {
      if (stamped.samples == 0) return;
      oldest = std::max(oldest, stamped.age(tick.now));
      put(stamped.value);
    };
    take(protocol_->angles(), [&](const ImuAngles& angles) {
      values[kYaw] = static_cast<double>(angles.yaw_deg);
      values[kPitch] = static_cast<double>(angles.pitch_deg);
      values[kRoll] = static_cast<double>(angles.roll_deg);
    });
    take(protocol_->rates(), [&](const ImuRates& rates) {
      values[kYawRate] = static_cast<double>(rates.z_deg_s);
      values[kPitchRate] = static_cast<double>(rates.y_deg_s);
      values[kRollRate] = static_cast<double>(rates.x_deg_s);
    });
    take(protocol_->acceleration(), [&](const ImuAcceleration& acceleration) {
      values[kAccX] = static_cast<double>(acceleration.x_m_s2);
      values[kAccY] = static_cast<double>(acceleration.y_m_s2);
      values[kAccZ] = static_cast<double>(acceleration.z_m_s2);
    });
    return protocol_->angles().samples == 0 ? Duration::max() : oldest;
  }

  Duration readInputs(std::array<double, kAxes>& values) const noexcept {
    if (!commanded()) return Duration::max();
    for (std::size_t i = 0; i < kAxes; ++i) values[i] = input(i);
    return Duration{0};  // valid as long as the message
  }

  std::string path_;
  SerialFormat format_;
  Duration max_age_;
  double yaw_offset_deg_;
  std::unique_ptr<ImuProtocol> owned_;
  const ImuProtocol* protocol_;  ///< Null: the inputs.
  Silence silence_{kSilent, kBack};
};

class ImuType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "imu"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "An inertial sensor: angles, rates and acceleration.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kImuKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline&) const override {
    const bool by_inputs = settings.own.text("protocol") == "inputs";
    if (by_inputs == settings.own.given("port"))
      return fail(by_inputs ? "port: means nothing with protocol: inputs; remove it"
                            : "port: is missing; add the serial port of the sensor");
    return std::make_unique<Imu>(settings.own);
  }
};

}  // namespace

const ModuleType& imuType() noexcept {
  static const ImuType kType;
  return kType;
}

}  // namespace rc10
