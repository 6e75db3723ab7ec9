#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "bus/serial_format.hpp"
#include "module/module_type.hpp"
#include "module/serial_link_field.hpp"

namespace rc10 {

/// Outputs of a serial link itself, after those of its fields.
inline constexpr std::array<std::string_view, 3> kLinkSignals{"connected", "age_ms", "errors"};

[[nodiscard]] std::span<const OwnKey> serialLinkKeys() noexcept;

/// Fields of the list `key`: `receive` or `send`.
[[nodiscard]] std::vector<SerialLinkField> linkFields(const OwnValues& own, std::string_view key);

/// Range of a signal, by the range of its field.
[[nodiscard]] WireRange linkRange(const OwnValues& row, std::string_view protocol);

/// Format of the port, of a link whose fields fit each other, their protocol, the line and the ticks.
[[nodiscard]] Result<SerialFormat> checkSerialLink(const OwnValues& own, int tick_hz);

}  // namespace rc10
