#include "module/gpio_module.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "app/debouncer.hpp"
#include "module/held_back.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

// With `connected` they fit into a module's outputs.
constexpr double kMaxLines = 15;
constexpr std::string_view kConnectedSignal = "connected";

constexpr OwnKey kLineName{.name = "name",
                           .kind = kText,
                           .required = true,
                           .about = "Name of its signal, unique in the module.",
                           .pattern = "[a-z0-9_]{1,31}",
                           .words = "a name of a-z, 0-9 and _, at most 31 characters"};
constexpr OwnKey kLine{.name = "line",
                       .kind = kInteger,
                       .max = 1023,
                       .required = true,
                       .about = "Line of the chip. On a Raspberry Pi the BCM number: 17 is GPIO17, pin 11."};
constexpr OwnKey kActiveLow{.name = "active_low",
                            .kind = kFlag,
                            .default_text = "false",
                            .about = "The signal is 1 while the line is low."};

constexpr std::array<std::string_view, 4> kBiases{"as_is", "none", "pull_up", "pull_down"};

constexpr std::array kInputKeys{
    kLineName, kLine, kActiveLow,
    OwnKey{.name = "bias",
           .kind = kChoice,
           .choices = kBiases,
           .default_text = "as_is",
           .about = "The chip's own resistor. as_is: as the board or its device tree has set it."},
    OwnKey{.name = "debounce_ms",
           .kind = kInteger,
           .unit = "ms",
           .max = 1000,
           .default_text = "5",
           .about = "A new level counts once it has lasted for so long. 0: at once."}};

constexpr std::array<std::string_view, 2> kAtEstop{"safe", "keep"};

constexpr std::array kOutputKeys{
    kLineName, kLine, kActiveLow,
    OwnKey{.name = "safe_value",
           .kind = kInteger,
           .max = 1,
           .default_text = "0",
           .about = "What it is at the start, while nobody commands it, and at the end."},
    OwnKey{.name = "on_estop",
           .kind = kChoice,
           .choices = kAtEstop,
           .default_text = "safe",
           .about =
               "safe: the safe value from the e-stop on, until it was commanded safe once after it. keep: "
               "obeys all the same, as a gripper that must not drop what it holds."}};

constexpr std::array kGpioKeys{
    OwnKey{.name = "chip",
           .kind = kText,
           .required = true,
           .about =
               "GPIO chip: its name (gpiochip0) or its label (pinctrl-rp1), which stays the same when the "
               "numbers change.",
           .pattern = "[A-Za-z0-9_.:/@-]{1,64}",
           .words = "name or label of a GPIO chip, as `gpiodetect` shows it"},
    OwnKey{.name = "inputs",
           .kind = kRows,
           .max = kMaxLines,
           .about = "Lines that are read.",
           .keys = kInputKeys},
    OwnKey{.name = "outputs",
           .kind = kRows,
           .max = kMaxLines,
           .about = "Lines that are driven.",
           .keys = kOutputKeys}};

/// Age at which a reading is void: a slow chip is read every few milliseconds, and one that hangs in a
/// transfer reports no error. The distance is that of the grid, in which a computer that stood still
/// as a whole is no silence.
constexpr float kOldestReadingSeconds = 0.1F;
/// As long as the lines thread waits for a tick before the outputs are safe.
constexpr Duration kLongestTick = std::chrono::milliseconds{200};

[[nodiscard]] GpioBias biasOf(const std::string& word) {
  if (word == "none") return GpioBias::kNone;
  if (word == "pull_up") return GpioBias::kPullUp;
  return word == "pull_down" ? GpioBias::kPullDown : GpioBias::kAsIs;
}

[[nodiscard]] ModuleSignals signalsOf(const OwnValues& own) {
  ModuleSignals signals;
  for (const auto& row : own.rows("outputs")) signals.inputs.push_back(row.text("name"));
  for (const auto& row : own.rows("inputs")) signals.outputs.push_back(row.text("name"));
  for (const auto& row : own.rows("outputs")) signals.outputs.push_back(row.text("name"));
  signals.outputs.emplace_back(kConnectedSignal);
  signals.events = {
      {.text = "after a start, an e-stop or a loss of its line an output stays at its safe value until it is "
               "commanded so once, or not at all for 1 s",
       .expected = true}};
  return signals;
}

[[nodiscard]] constexpr bool bit(std::uint32_t levels, std::size_t place) noexcept {
  return ((levels >> place) & 1U) != 0;
}

[[nodiscard]] constexpr double asNumber(bool value) noexcept { return value ? 1.0 : 0.0; }

class GpioModule : public Module_Base {
 public:
  explicit GpioModule(const OwnValues& own)
      : Module_Base(signalsOf(own)), owned_(std::make_unique<GpioImage>()), image_(owned_.get()) {
    need_.chip = own.text("chip");
    for (const auto& row : own.rows("inputs")) {
      need_.inputs.push_back(
          {.name = row.text("name"), .line = row.integer("line"), .bias = biasOf(row.text("bias"))});
      inputs_.push_back({.debouncer = Debouncer{std::chrono::milliseconds{row.integer("debounce_ms")}},
                         .active_low = row.flag("active_low")});
    }
    for (const auto& row : own.rows("outputs")) {
      need_.outputs.push_back({.name = row.text("name"), .line = row.integer("line")});
      outputs_.push_back({.active_low = row.flag("active_low"),
                          .safe = row.flag("safe_value"),
                          .keeps_at_estop = row.text("on_estop") == "keep"});
      setLevel(need_.safe_levels, outputs_.size() - 1, outputs_.back().safe);
    }
    image_->outputs = need_.safe_levels;
  }

  [[nodiscard]] std::optional<GpioNeed> takeGpioNeed() override {
    need_.image = std::move(owned_);
    return std::move(need_);
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    readInputs(tick);
    driveOutputs(tick, robot);
    setOutput(inputs_.size() + outputs_.size(), asNumber(image_->open));
  }

 private:
  enum EventPlace : std::size_t { kHeldBack };

  struct Input {
    Debouncer debouncer;
    bool active_low = false;
  };
  struct Output {
    bool active_low = false;
    bool safe = false;
    bool keeps_at_estop = false;
    HeldBack held_back{};
  };

  void readInputs(const Tick& tick) noexcept {
    const bool read = std::exchange(readings_, image_->readings) != image_->readings;
    reading_age_s_ = read ? 0.0F : reading_age_s_ + tick.dt_s;
    const bool known = image_->open && reading_age_s_ < kOldestReadingSeconds;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      auto& input = inputs_[i];
      if (!known) {
        input.debouncer.restart();
        setOutput(i, kNoSignal);
      } else if (read) {
        setOutput(i, asNumber(input.debouncer.step(bit(image_->inputs, i) != input.active_low, tick.now)));
      }
    }
  }

  void driveOutputs(const Tick& tick, ModuleRobot& robot) noexcept {
    const bool running = robot.state() == RobotStatus::kRun;
    const bool lost = (was_open_ && !image_->open) || (last_tick_ && tick.now - *last_tick_ > kLongestTick);
    was_open_ = image_->open;
    last_tick_ = tick.now;
    bool held_back = false;
    bool in_vain = false;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      auto& output = outputs_[i];
      const double asked = input(i);
      const bool wanted = std::isfinite(asked) ? asked >= 0.5 : output.safe;
      const bool held = output.held_back.step(
          {.given = std::isfinite(asked), .safe = wanted == output.safe},
          {.usable = running && image_->open, .dropped = lost || (!running && !output.keeps_at_estop)}, tick);
      held_back |= held;
      in_vain |= running && held && wanted != output.safe;
      const bool value = held ? output.safe : wanted;
      setLevel(image_->outputs, i, value);
      const bool driven = image_->open && !bit(image_->unwritten, i);
      setOutput(inputs_.size() + i, driven ? asNumber(value) : kNoSignal);
    }
    if (in_vain && !std::exchange(told_, true)) robot.report(kHeldBack);
    if (!held_back) told_ = false;
  }

  void setLevel(std::uint32_t& levels, std::size_t place, bool value) const noexcept {
    const std::uint32_t mask = 1U << place;
    levels = value != outputs_[place].active_low ? levels | mask : levels & ~mask;
  }

  std::vector<Input> inputs_;
  std::vector<Output> outputs_;
  GpioNeed need_;
  std::unique_ptr<GpioImage> owned_;
  GpioImage* image_;
  std::uint32_t readings_ = 0;
  float reading_age_s_ = kOldestReadingSeconds;
  bool told_ = false;
  bool was_open_ = false;
  std::optional<MonotonicTime> last_tick_;
};

class GpioModuleType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "gpio"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "Switches and valves on lines of a GPIO chip.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kGpioKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline&) const override {
    std::vector<std::string> names{std::string{kConnectedSignal}};
    for (const auto* key : {"inputs", "outputs"}) {
      const auto& rows = settings.own.rows(key);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto name = rows[i].text("name");
        if (std::find(names.begin(), names.end(), name) != names.end()) {
          return fail(std::string{key} + "[" + std::to_string(i) + "].name: there is a signal '" + name +
                      "' already; give each line another name");
        }
        names.push_back(name);
      }
    }
    if (names.size() == 1) return fail("inputs: there is no line; name at least one in inputs or outputs");
    return std::make_unique<GpioModule>(settings.own);
  }
};

}  // namespace

const ModuleType& gpioModuleType() noexcept {
  static const GpioModuleType kType;
  return kType;
}

}  // namespace rc10
