#include "module/rangefinder.hpp"

#include <array>
#include <string>

#include "module/serial_keys.hpp"
#include "module/tfmini_protocol.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

constexpr std::array<std::string_view, 2> kUnits{"cm", "mm"};

constexpr std::array kRangefinderKeys{kPortKey,
                                      OwnKey{.name = "unit",
                                             .kind = kChoice,
                                             .choices = kUnits,
                                             .default_text = "cm",
                                             .about = "What the sensor is set to send."},
                                      OwnKey{.name = "max_age_ms",
                                             .kind = kInteger,
                                             .unit = "ms",
                                             .min = 5,
                                             .max = 5000,
                                             .default_text = "50",
                                             .about = "Older values mean nothing: the output is NaN."}};

class Rangefinder : public Module_Base {
 public:
  explicit Rangefinder(const OwnValues& own)
      : Module_Base({.inputs = {}, .outputs = {"distance_m", "strength", "age_ms"}, .events = {}}),
        path_(own.text("port")),
        max_age_(std::chrono::milliseconds{own.integer("max_age_ms")}),
        owned_(std::make_unique<TfminiProtocol>(own.text("unit") == "mm"
                                                    ? TfminiProtocol::Unit::kMillimetre
                                                    : TfminiProtocol::Unit::kCentimetre)),
        protocol_(owned_.get()) {}

  [[nodiscard]] std::optional<SerialNeed> takeSerialNeed() override {
    return SerialNeed{.path = path_, .format = {}, .protocol = std::move(owned_)};
  }

  void update(const Tick& tick, ModuleRobot&) noexcept override {
    const auto& range = protocol_->range();
    const Duration age = range.age(tick.now);
    const bool fresh = age <= max_age_;
    setOutput(kDistance,
              fresh && range.value.valid ? static_cast<double>(range.value.distance_m) : kNoSignal);
    setOutput(kStrength, fresh ? static_cast<double>(range.value.strength) : kNoSignal);
    setAge(kAgeMs, age);
  }

 private:
  enum Output : std::size_t { kDistance, kStrength, kAgeMs };

  std::string path_;
  Duration max_age_;
  std::unique_ptr<TfminiProtocol> owned_;
  const TfminiProtocol* protocol_;
};

class RangefinderType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "rangefinder"; }
  [[nodiscard]] std::string_view about() const noexcept override { return "A TFmini laser rangefinder."; }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kRangefinderKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline&) const override {
    return std::make_unique<Rangefinder>(settings.own);
  }
};

}  // namespace

const ModuleType& rangefinderType() noexcept {
  static const RangefinderType kType;
  return kType;
}

}  // namespace rc10
