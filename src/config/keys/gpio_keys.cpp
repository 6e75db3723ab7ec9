#include <array>

#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

constexpr TextForm kChip{"[A-Za-z0-9_.:/@-]{1,64}", "name or label of a GPIO chip, as `gpiodetect` shows it"};
constexpr Range kLines{.min = 0, .max = 1023};

std::vector<std::string_view> levels() { return {"low", "high"}; }
std::vector<std::string_view> biases() { return {"internal", "external"}; }

constexpr Key kChipKey{.name = "chip",
                       .kind = kText,
                       .form = &kChip,
                       .required = true,
                       .about =
                           "GPIO chip: its name (gpiochip0) or its label (pinctrl-rp1), which stays the "
                           "same when the numbers change."};
constexpr Key kLineKey{.name = "line",
                       .kind = kInteger,
                       .range = kLines,
                       .required = true,
                       .about = "Line of the chip. On a Raspberry Pi the BCM number: 17 is GPIO17, pin 11."};

constexpr std::array kContactKeys{
    kChipKey, kLineKey,
    Key{.name = "closed_level",
        .kind = kText,
        .choices = levels,
        .default_text = "low",
        .about = "What the line reads while the contact is closed and all is well. low: contact to ground. "
                 "high: contact to 3.3 V."},
    Key{.name = "bias",
        .kind = kText,
        .choices = biases,
        .default_text = "internal",
        .about = "What pulls the line to the other level when the contact or a wire is open. internal: the "
                 "chip's own resistor. external: one on the board; needed where the chip has none."}};

constexpr std::array kHeartbeatKeys{
    kChipKey, kLineKey,
    Key{.name = "period_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 10, .max = 1000},
        .default_text = "20",
        .about = "Period of the square wave; at least four of the scheduler's."},
    Key{.name = "stops_on_estop_after_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 0, .max = 600'000},
        .about =
            "Time after the beginning of an e-stop at which it stops, and the relay cuts the motors' power; "
            "longer than on_estop needs to brake them. It toggles again when the e-stop is cleared. "
            "Without it it never stops for that."}};

}  // namespace

constexpr Section kEstopGpioSection{"estop_gpio", kContactKeys,
                                    "An emergency-stop contact on a GPIO line, normally closed."};
constexpr Section kEnablingGpioSection{
    "enabling_gpio", kContactKeys,
    "The contact of a three-position enabling switch on a GPIO line, closed in the middle position alone."};
constexpr Section kModeGpioSection{
    "mode_gpio", kContactKeys,
    "A contact on a GPIO line that is open while a person is near, as that of a guard door."};
constexpr Section kHeartbeatGpioSection{"heartbeat_gpio", kHeartbeatKeys,
                                        "A GPIO line that toggles while the scheduler ticks."};

}  // namespace rc10
