#include "module/led_strip.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fake_robot.hpp"
#include "module/ws2812_encoder.hpp"

namespace rc10::test::led_strip_test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

constexpr std::size_t kPixels = 4;
constexpr Rgb kRed{1.0F, 0.0F, 0.0F};
constexpr Rgb kGreen{0.0F, 1.0F, 0.0F};
constexpr Rgb kBlack{};

ModuleSettings settingsOf(int pixels, const std::string& speed_hz = "3200000") {
  ModuleSettings settings;
  settings.name = "strip";
  settings.own.set("device", std::string{"/dev/spidev0.0"});
  settings.own.set("pixels", static_cast<double>(pixels));
  settings.own.set("colour_order", std::string{"grb"});
  settings.own.set("speed_hz", speed_hz);
  settings.own.set("brightness_limit", 1.0);
  settings.own.set("status_pixels", 1.0);
  return settings;
}

class LedStripTest : public ::testing::Test {
 protected:
  enum Place : std::size_t { kState, kShowsInputs, kConnected };

  LedStripTest() { build(settingsOf(kPixels)); }
  void build(const ModuleSettings& settings) {
    module = std::move(ledStripType().build(settings, outlineOf(3)).value());
    need = std::move(*module->takeSpiNeed());
    for (auto& motor : robot.motors()) motor.status = MotorStatus::kReady;
  }

  void run(int ticks = 40) {
    for (int i = 0; i < ticks; ++i) robot.update(*module);
  }
  /// The strip after the next frame, each colour rounded to off or on.
  std::vector<Rgb> shown() {
    run();
    std::vector<Rgb> pixels;
    // Four bytes for each colour behind the reset; in the order green, red, blue.
    const auto part = [&](std::size_t at) { return need.output->bytes[120 + 4 * at] >= 0xE0 ? 1.0F : 0.0F; };
    for (std::size_t i = 0; i < kPixels; ++i)
      pixels.push_back({part(3 * i + 1), part(3 * i), part(3 * i + 2)});
    return pixels;
  }
  /// All that is seen of the first pixel in some seconds.
  std::vector<Rgb> seenOfTheFirst() {
    std::vector<Rgb> seen;
    for (int i = 0; i < 60; ++i) {
      const auto pixel = shown()[0];
      if (std::find(seen.begin(), seen.end(), pixel) == seen.end()) seen.push_back(pixel);
    }
    return seen;
  }
  void colour(double red, double green, double blue, double brightness = kNoSignal) {
    module->setInputs(std::array{red, green, blue, brightness});
  }
  double signal(Place place) { return module->outputs()[place]; }

  FakeRobot robot{3};
  std::unique_ptr<Module_Base> module;
  SpiNeed need;
};

TEST_F(LedStripTest, TheDaemonLearnsDeviceSpeedAndTheDarkPicture) {
  EXPECT_EQ(need.path, "/dev/spidev0.0");
  EXPECT_EQ(need.speed_hz, 3'200'000U);
  EXPECT_EQ(need.rest.size(), Ws2812Encoder::bytesFor(Ws2812Encoder::Rate::k4Bits, kPixels));
  EXPECT_THAT((std::vector(need.rest.begin() + 120, need.rest.end() - 120)), Each(0x88));
}

TEST_F(LedStripTest, ThirtyPicturesAreMadeASecondAndAPauseIsNotMadeUpFor) {
  run(1000);
  EXPECT_GE(need.output->frames, 29U);
  EXPECT_LE(need.output->frames, 31U);
  EXPECT_EQ(need.output->size, need.rest.size());
}

TEST_F(LedStripTest, AnEnabledRobotIsGreen) {
  robot.motor(1).status = MotorStatus::kActive;
  EXPECT_THAT(shown(), Each(kGreen));
  EXPECT_EQ(signal(kState), 1.0);
}

TEST_F(LedStripTest, ADisabledOneBreathesAndIsNeverQuiteDark) {
  for (int i = 0; i < 150; ++i) {
    run();
    EXPECT_NE(std::vector(need.output->bytes.begin(),
                          need.output->bytes.begin() + static_cast<std::ptrdiff_t>(need.output->size)),
              need.rest);
  }
  EXPECT_EQ(signal(kState), 0.0);
}

TEST_F(LedStripTest, AFaultIsMoreImportantThanMotorsThatRun) {
  robot.motor(0).status = MotorStatus::kActive;
  robot.motor(2).status = MotorStatus::kFault;
  run();
  EXPECT_EQ(signal(kState), 2.0);
  for (const auto& pixel : seenOfTheFirst()) EXPECT_EQ(pixel.blue, 0.0F);
}

TEST_F(LedStripTest, AnEstopBlinksRedWhateverElseIs) {
  robot.motor(2).status = MotorStatus::kFault;
  robot.setState(RobotStatus::kEstop);
  EXPECT_THAT(seenOfTheFirst(), ::testing::UnorderedElementsAre(kRed, kBlack));
  EXPECT_EQ(signal(kState), 3.0);
}

TEST_F(LedStripTest, AProgramColoursTheStripExceptTheStatusPixels) {
  robot.motor(1).status = MotorStatus::kActive;
  colour(255.0, kNoSignal, 255.0);
  const auto pixels = shown();
  EXPECT_EQ(pixels[0], kGreen);
  for (std::size_t i = 1; i < kPixels; ++i) EXPECT_EQ(pixels[i], (Rgb{1.0F, 0.0F, 1.0F}));
  EXPECT_EQ(signal(kShowsInputs), 1.0);
  module->clearInputs();
  EXPECT_THAT(shown(), Each(kGreen));
  EXPECT_EQ(signal(kShowsInputs), 0.0);
}

TEST_F(LedStripTest, ABrightnessAloneDimsThePattern) {
  robot.motor(1).status = MotorStatus::kActive;
  colour(kNoSignal, kNoSignal, kNoSignal, 0.0);
  const auto pixels = shown();
  EXPECT_EQ(pixels[0], kGreen) << "a status pixel";
  EXPECT_EQ(pixels[1], kBlack);
  EXPECT_EQ(signal(kShowsInputs), 0.0);
}

TEST_F(LedStripTest, NothingReplacesOrDimsAnEstopOrAFault) {
  colour(0.0, 0.0, 255.0, 0.0);
  robot.setState(RobotStatus::kEstop);
  bool red = false;
  for (int i = 0; i < 30; ++i) {
    const auto pixels = shown();
    EXPECT_THAT(pixels, Each(pixels[0]));
    EXPECT_EQ(pixels[0].blue, 0.0F);
    red |= pixels[3] == kRed;
  }
  EXPECT_TRUE(red);
  EXPECT_EQ(signal(kShowsInputs), 0.0);
  robot.setState(RobotStatus::kRun);
  robot.motor(0).status = MotorStatus::kFault;
  EXPECT_THAT(shown(), Each(shown()[0]));
  EXPECT_EQ(signal(kShowsInputs), 0.0);
}

TEST_F(LedStripTest, EachPatternCanBeChosen) {
  auto settings = settingsOf(kPixels);
  OwnValues enabled;
  enabled.set("pattern", std::string{"steady"});
  enabled.set("colour", std::string{"#FF00FF"});
  settings.own.set("enabled", std::vector{enabled});
  build(settings);
  robot.motor(1).status = MotorStatus::kActive;
  EXPECT_THAT(shown(), Each(Rgb{1.0F, 0.0F, 1.0F}));
}

TEST_F(LedStripTest, TheBrightnessLimitHolds) {
  auto settings = settingsOf(kPixels);
  settings.own.set("brightness_limit", 0.1);
  build(settings);
  colour(255.0, 255.0, 255.0);
  run();
  // 0.1 of 255 is 26: the highest three bits are 0, whatever the pixel.
  for (std::size_t i = 0; i < kPixels * 3; ++i) {
    EXPECT_EQ(need.output->bytes[120 + 4 * i], 0x88);
    EXPECT_LT(need.output->bytes[121 + 4 * i], 0xE0);
  }
}

TEST_F(LedStripTest, ConnectedIsWhatTheDaemonSays) {
  run(1);
  EXPECT_EQ(signal(kConnected), 0.0);
  need.output->open = true;
  run(1);
  EXPECT_EQ(signal(kConnected), 1.0);
}

TEST(LedStripType, TooManyPixelsAreRefusedWithTheLimitAndTheRemedies) {
  EXPECT_TRUE(ledStripType().build(settingsOf(321), outlineOf(1)));
  const auto refused = ledStripType().build(settingsOf(400), outlineOf(1)).error().message;
  EXPECT_THAT(refused, HasSubstr("pixels: 400 pixels take 5040 bytes"));
  EXPECT_THAT(refused, HasSubstr("4096"));
  EXPECT_THAT(refused, HasSubstr("at most 321"));
  EXPECT_THAT(refused, HasSubstr("speed_hz: 2400000"));
  EXPECT_TRUE(ledStripType().build(settingsOf(435, "2400000"), outlineOf(1)));
  EXPECT_THAT(ledStripType().build(settingsOf(436, "2400000"), outlineOf(1)).error().message,
              HasSubstr("use at most 435, or a second strip"));
}

}  // namespace
}  // namespace rc10::test::led_strip_test
