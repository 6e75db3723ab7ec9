#include "module/module_base.hpp"

#include <array>
#include <cmath>

#include <gmock/gmock.h>

namespace rc10::test::module_base_test {
namespace {

using ::testing::ElementsAre;

class Probe : public Module_Base {
 public:
  Probe() : Module_Base({.inputs = {"vx_m_s", "wz_deg_s"}, .outputs = {"x_m"}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
  using Module_Base::commanded;
  using Module_Base::input;
};

TEST(ModuleBase, WithoutACommandItsInputsAreNotGivenAndItsOutputsMeanNothing) {
  const Probe probe;
  EXPECT_FALSE(probe.commanded());
  EXPECT_TRUE(std::isnan(probe.input(0)));
  EXPECT_TRUE(std::isnan(probe.outputs()[0]));
}

TEST(ModuleBase, AMessageReplacesAllInputs) {
  Probe probe;
  probe.setInputs(std::array{1.0, 2.0});
  probe.setInputs(std::array{3.0, kNoSignal});
  EXPECT_EQ(probe.input(0), 3.0);
  EXPECT_TRUE(std::isnan(probe.input(1)));
  probe.clearInputs();
  EXPECT_FALSE(probe.commanded());
  EXPECT_TRUE(std::isnan(probe.input(0)));
}

TEST(ModuleBase, MoreValuesThanInputsDoNoHarm) {
  Probe probe;
  probe.setInputs(std::array{1.0, 2.0, 3.0});
  EXPECT_EQ(probe.input(1), 2.0);
}

TEST(ModuleDirectory, FindsAnInputByTheNamesOfModuleAndInput) {
  const Probe base;
  const Probe arm;
  const ModuleDirectory directory{{{"base", &base}, {"arm", &arm}}};
  const auto place = directory.findInput("arm.wz_deg_s");
  ASSERT_TRUE(place.has_value());
  EXPECT_EQ(place->module, 1U);
  EXPECT_EQ(place->signal, 1U);
  EXPECT_EQ(directory.findOutput("base.x_m").value().module, 0U);
}

TEST(ModuleDirectory, SaysWhatThereIs) {
  const Probe base;
  const ModuleDirectory directory{{{"base", &base}}};
  EXPECT_EQ(directory.findInput("bas.vx_m_s").error().message,
            "there is no module 'bas'; there are base; did you mean base?");
  EXPECT_EQ(directory.findInput("base.vx").error().message,
            "module 'base' has no input 'vx'; it has vx_m_s, wz_deg_s; did you mean vx_m_s?");
  EXPECT_EQ(directory.findInput("base").error().message,
            "module 'base' has no input ''; it has vx_m_s, wz_deg_s");
  EXPECT_EQ(directory.findOutput("base.vx_m_s").error().message,
            "module 'base' has no output 'vx_m_s'; it has x_m");
}

}  // namespace
}  // namespace rc10::test::module_base_test
