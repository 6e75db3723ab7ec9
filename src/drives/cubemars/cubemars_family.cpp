#include "drives/cubemars/cubemars_family.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "drives/cubemars/cubemars_frames.hpp"
#include "drives/cubemars/cubemars_mit.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "drives/cubemars/cubemars_servo.hpp"

namespace rc10 {
namespace {

// Commands of the servo protocol are 0 to 8 in bits 8 and up; more is no command.
constexpr std::uint32_t kServoCommandMask = 0x1FFF'F0FFU;

std::vector<std::string_view> namesOf(std::span<const CubeMarsModel> models) {
  std::vector<std::string_view> names;
  for (const auto& model : models) names.push_back(model.name);
  return names;
}

/// How often what is told leaves, and for drives that only answer also what comes back.
double commandsPerSecond(const MotorSettings& settings) {
  return static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1);
}

class CubeMarsFamily final : public MotorFamily {
 public:
  CubeMarsFamily() : names_(namesOf(cubemarsModels())) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "CubeMars"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override { return names_; }
  [[nodiscard]] std::span<const FamilyKey> keys() const noexcept override { return cubemarsKeys(); }
  [[nodiscard]] MotorTraits traits(std::string_view model, const OwnValues& own) const override {
    return cubemarsTraits(cubemarsSetup(model, own));
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    const auto setup = cubemarsSetup(settings.model, settings.own);
    const std::string model{setup.model->name};
    if (setup.protocol == CubeMarsProtocol::kMitV3 && !setup.model->v3) {
      return fail("protocol: the " + model + " is no V3 drive: write mit, or " + model + "-V3 as the model");
    }
    if (setup.protocol == CubeMarsProtocol::kMit && setup.model->v3) {
      return fail("protocol: a V3 drive like the " + model + " does not understand mit: write mit_v3");
    }
    if (setup.protocol == CubeMarsProtocol::kMit && settings.own.text("position_basis") != "output") {
      return fail("position_basis: the protocol mit has positions of the output: leave the key out");
    }
    return {};
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const auto setup = cubemarsSetup(settings.model, settings.own);
    const double told = commandsPerSecond(settings);
    BusUse use;
    if (setup.protocol == CubeMarsProtocol::kMit) {
      const PayloadDiscriminator own{.value = static_cast<std::uint8_t>(settings.id)};
      const CanId id = cubemars::mitId(settings.id);
      use.sends = {{.id = {0, false}, .mask = kStandardIdMask, .discriminator = own},
                   {.id = id, .mask = kStandardIdMask, .discriminator = own}};
      use.obeys = {{.id = id, .mask = kStandardIdMask}};
      use.commands = {{.id = id, .shape = {.length = 8}, .per_second = told}};
      use.feedback = {{.id = {0, false}, .shape = {.length = 8}, .per_second = told}};
      return use;
    }
    const auto traits = cubemarsTraits(setup);
    const bool servo = setup.protocol == CubeMarsProtocol::kServo;
    const int feedback_hz = settings.feedback_hz > 0 ? settings.feedback_hz : traits.feedback_hz;
    const CanId feedback_id = cubemars::servoFeedbackId(settings.id);
    const CanId command_id = cubemars::servoId(
        servo ? cubemars::ServoCommand::kPositionVelocity : cubemars::ServoCommand::kMit, settings.id);
    use.sends = {{.id = feedback_id}};
    use.obeys = {{.id = {static_cast<std::uint32_t>(settings.id), true}, .mask = kServoCommandMask}};
    // The longest of its commands.
    use.commands = {{.id = command_id, .shape = {.extended = true, .length = 8}, .per_second = told}};
    use.feedback = {{.id = feedback_id,
                     .shape = {.extended = true, .length = 8},
                     .per_second = static_cast<double>(feedback_hz)}};
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    const auto setup = cubemarsSetup(settings.model, settings.own);
    if (setup.protocol == CubeMarsProtocol::kServo) {
      return registerSolo(std::make_unique<CubeMarsServo>(settings, setup), parts);
    }
    return registerSolo(std::make_unique<CubeMarsMit>(settings, setup), parts);
  }

 private:
  std::vector<std::string_view> names_;
};

}  // namespace

const MotorFamily& cubemarsFamily() noexcept {
  static const CubeMarsFamily kFamily;
  return kFamily;
}

}  // namespace rc10
