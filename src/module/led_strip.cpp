#include "module/led_strip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "module/led_effect.hpp"
#include "module/ws2812_encoder.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

constexpr Duration kFrameInterval = std::chrono::nanoseconds{1'000'000'000 / 30};

constexpr std::array<std::string_view, 4> kPatterns{"steady", "blink", "breathe", "run"};
constexpr std::array<std::string_view, 6> kOrders{"grb", "rgb", "brg", "bgr", "gbr", "rbg"};
constexpr std::array<std::string_view, 2> kSpeeds{"3200000", "2400000"};

/// The keys of what is shown in one state, with their defaults.
constexpr std::array<OwnKey, 4> effectKeys(std::string_view pattern, std::string_view colour,
                                           std::string_view second_colour, std::string_view period_ms) {
  return {
      OwnKey{.name = "pattern",
             .kind = kChoice,
             .choices = kPatterns,
             .default_text = pattern,
             .about = "steady; blink: both colours in turn; breathe: from one to the other and back; run: "
                      "a quarter of the strip runs over the second colour."},
      OwnKey{.name = "colour",
             .kind = kText,
             .default_text = colour,
             .about = "What is seen.",
             .pattern = kColourPattern,
             .words = kColourWords},
      OwnKey{.name = "second_colour",
             .kind = kText,
             .default_text = second_colour,
             .about = "Second colour of blink, breathe and run.",
             .pattern = kColourPattern,
             .words = kColourWords},
      OwnKey{.name = "period_ms",
             .kind = kInteger,
             .unit = "ms",
             .min = 100,
             .max = 60'000,
             .default_text = period_ms,
             .about = "Period of blink, breathe and run."}};
}

// More than three flashes a second may harm people with epilepsy (WCAG 2.1, 2.3.1): 400 ms is 2.5 of them.
constexpr auto kEstopKeys = effectKeys("blink", "red", "black", "400");
constexpr auto kFaultKeys = effectKeys("blink", "red", "amber", "1000");
constexpr auto kEnabledKeys = effectKeys("steady", "green", "black", "1000");
// Never quite dark: a dark strip says that rc10d does not run.
constexpr auto kDisabledKeys = effectKeys("breathe", "#404060", "#040408", "4000");

constexpr std::array kLedStripKeys{
    OwnKey{.name = "device",
           .kind = kText,
           .required = true,
           .about = "The SPI device whose data line (MOSI) goes to the strip; one strip each.",
           .pattern = "/dev/[A-Za-z0-9_./:+-]{1,120}",
           .words = "a path under /dev: /dev/spidev0.0"},
    OwnKey{.name = "pixels",
           .kind = kInteger,
           .min = 1,
           .max = 1000,
           .required = true,
           .about = "LEDs on the strip: up to 321, or 435 with speed_hz: 2400000, which is what spidev "
                    "sends at once."},
    OwnKey{.name = "colour_order",
           .kind = kChoice,
           .choices = kOrders,
           .default_text = "grb",
           .about = "The order in which the strip takes the colours."},
    OwnKey{.name = "speed_hz",
           .kind = kChoice,
           .unit = "Hz",
           .choices = kSpeeds,
           .default_text = "3200000",
           .about = "Clock of the SPI bus. 3200000 suits every WS2812B; 2400000 needs a quarter fewer bytes, "
                    "for longer strips of the older chips."},
    OwnKey{.name = "brightness_limit",
           .kind = kNumber,
           .max = 1,
           .above_min = true,
           .default_text = "0.25",
           .about = "Highest brightness. A pixel takes up to 60 mA at 5 V when it is white and at 1."},
    OwnKey{.name = "status_pixels",
           .kind = kInteger,
           .max = 1000,
           .default_text = "0",
           .about =
               "Number of pixels, from the first, that show the state of the robot whatever the inputs say."},
    OwnKey{.name = "estop", .kind = kSection, .about = "Shown in an e-stop.", .keys = kEstopKeys},
    OwnKey{
        .name = "fault", .kind = kSection, .about = "Shown while a motor has a fault.", .keys = kFaultKeys},
    OwnKey{.name = "enabled",
           .kind = kSection,
           .about = "Shown while a motor is ACTIVE or about to be.",
           .keys = kEnabledKeys},
    OwnKey{.name = "disabled",
           .kind = kSection,
           .about = "Shown while no motor is ACTIVE.",
           .keys = kDisabledKeys}};

/// States of the robot, the most important last: the numbers of the output `state`.
enum class Shown : std::uint8_t { kDisabled, kEnabled, kFault, kEstop };

ModuleSignals stripSignals() {
  return {.inputs = {"red", "green", "blue", "brightness"},
          .outputs = {"state", "shows_inputs", "connected"},
          .events = {}};
}

/// As written, or its default: a section that was not written has none.
[[nodiscard]] std::string textOf(const OwnValues& section, const OwnKey& key) {
  return section.given(key.name) ? section.text(key.name) : std::string{key.default_text};
}

[[nodiscard]] LedEffect effectOf(const OwnValues& section, const std::array<OwnKey, 4>& keys) {
  const auto word = std::find(kPatterns.begin(), kPatterns.end(), textOf(section, keys[0]));
  const int period_ms = section.given(keys[3].name) ? section.integer(keys[3].name)
                                                    : std::stoi(std::string{keys[3].default_text});
  return {.pattern = static_cast<LedPattern>(std::distance(kPatterns.begin(), word)),
          .colour = colourOf(textOf(section, keys[1])),
          .second = colourOf(textOf(section, keys[2])),
          .period = std::chrono::milliseconds{period_ms}};
}

[[nodiscard]] Ws2812Encoder::Rate rateOf(const OwnValues& own) {
  return own.text("speed_hz") == kSpeeds[1] ? Ws2812Encoder::Rate::k3Bits : Ws2812Encoder::Rate::k4Bits;
}

[[nodiscard]] Shown shownFor(const ModuleRobot& robot) noexcept {
  if (robot.state() != RobotStatus::kRun) return Shown::kEstop;
  Shown shown = Shown::kDisabled;
  for (std::size_t motor = 0; motor < robot.motorCount(); ++motor) {
    switch (robot.status(motor)) {
      case MotorStatus::kFault: return Shown::kFault;
      case MotorStatus::kActive:
      case MotorStatus::kEnabling: shown = Shown::kEnabled; break;
      case MotorStatus::kOffline:
      case MotorStatus::kReady: break;
    }
  }
  return shown;
}

class LedStrip : public Module_Base {
 public:
  explicit LedStrip(const OwnValues& own)
      : Module_Base(stripSignals()),
        device_(own.text("device")),
        rate_(rateOf(own)),
        encoder_(rate_, own.text("colour_order")),
        brightness_limit_(static_cast<float>(own.number("brightness_limit"))),
        effects_{effectOf(own.section("disabled"), kDisabledKeys),
                 effectOf(own.section("enabled"), kEnabledKeys), effectOf(own.section("fault"), kFaultKeys),
                 effectOf(own.section("estop"), kEstopKeys)},
        picture_(static_cast<std::size_t>(own.integer("pixels"))),
        status_pixels_(std::min(static_cast<std::size_t>(own.integer("status_pixels")), picture_.size())),
        owned_(std::make_unique<SpiOutput>()),
        output_(owned_.get()) {}

  [[nodiscard]] std::optional<SpiNeed> takeSpiNeed() override {
    std::vector<std::uint8_t> dark(Ws2812Encoder::bytesFor(rate_, picture_.size()));
    (void)encoder_.encode(picture_, 0.0F, dark);
    return SpiNeed{.path = device_,
                   .speed_hz = Ws2812Encoder::speedHz(rate_),
                   .rest = std::move(dark),
                   .output = std::move(owned_)};
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const Shown shown = shownFor(robot);
    const bool inputs_shown = mayReplace(shown) && coloursGiven();
    setOutput(kState, static_cast<double>(shown));
    setOutput(kShowsInputs, inputs_shown ? 1.0 : 0.0);
    setOutput(kConnected, output_->open ? 1.0 : 0.0);
    if (tick.now < next_frame_) return;
    // A late frame is not made up for.
    const auto planned = next_frame_ + kFrameInterval;
    next_frame_ = planned > tick.now ? planned : tick.now + kFrameInterval;
    paint(effects_[static_cast<std::size_t>(shown)], tick.now, picture_);
    if (mayReplace(shown)) obeyInputs(std::span{picture_}.subspan(status_pixels_));
    output_->size = encoder_.encode(picture_, brightness_limit_, output_->bytes);
    ++output_->frames;
  }

 private:
  enum Input : std::size_t { kRed, kGreen, kBlue, kBrightness };
  enum Output : std::size_t { kState, kShowsInputs, kConnected };

  /// Warnings for people near the robot are neither replaced nor dimmed.
  [[nodiscard]] static bool mayReplace(Shown shown) noexcept { return shown < Shown::kFault; }

  [[nodiscard]] bool coloursGiven() const noexcept {
    return std::isfinite(input(kRed)) || std::isfinite(input(kGreen)) || std::isfinite(input(kBlue));
  }
  void obeyInputs(std::span<Rgb> pixels) const noexcept {
    const double brightness = input(kBrightness);
    const float scale =
        std::isfinite(brightness) ? static_cast<float>(std::clamp(brightness, 0.0, 1.0)) : 1.0F;
    if (coloursGiven())
      std::fill(pixels.begin(), pixels.end(),
                Rgb{part(input(kRed)), part(input(kGreen)), part(input(kBlue))});
    for (Rgb& pixel : pixels) pixel = {pixel.red * scale, pixel.green * scale, pixel.blue * scale};
  }
  [[nodiscard]] static float part(double given) noexcept {
    return std::isfinite(given) ? static_cast<float>(std::clamp(given, 0.0, 255.0) / 255.0) : 0.0F;
  }

  std::string device_;
  Ws2812Encoder::Rate rate_;
  Ws2812Encoder encoder_;
  float brightness_limit_;
  std::array<LedEffect, 4> effects_;  ///< By Shown.
  std::vector<Rgb> picture_;
  std::size_t status_pixels_;
  std::unique_ptr<SpiOutput> owned_;
  SpiOutput* output_;
  MonotonicTime next_frame_{};
};

class LedStripType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "led_strip"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "WS2812 pixels on an SPI bus that show the state of the robot.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kLedStripKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline&) const override {
    const auto rate = rateOf(settings.own);
    const auto pixels = static_cast<std::size_t>(settings.own.integer("pixels"));
    const auto bytes = Ws2812Encoder::bytesFor(rate, pixels);
    if (bytes > kMaxSpiBytes) return fail(tooLong(rate, pixels, bytes));
    return std::make_unique<LedStrip>(settings.own);
  }

 private:
  [[nodiscard]] static std::string tooLong(Ws2812Encoder::Rate rate, std::size_t pixels, std::size_t bytes) {
    const auto most = Ws2812Encoder::pixelsIn(rate, kMaxSpiBytes);
    const auto most_slow = Ws2812Encoder::pixelsIn(Ws2812Encoder::Rate::k3Bits, kMaxSpiBytes);
    std::string text = "pixels: " + std::to_string(pixels) + " pixels take " + std::to_string(bytes) +
                       " bytes, and spidev sends at most " + std::to_string(kMaxSpiBytes) +
                       " without a gap, which would end the picture; use at most " + std::to_string(most);
    if (most_slow > most && pixels <= most_slow)
      text += ", or speed_hz: 2400000 if the strip has older chips (up to " + std::to_string(most_slow) + ")";
    return text + ", or a second strip on another device";
  }
};

}  // namespace

const ModuleType& ledStripType() noexcept {
  static const LedStripType kType;
  return kType;
}

}  // namespace rc10
