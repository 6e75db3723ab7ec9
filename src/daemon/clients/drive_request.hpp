#pragma once

#include <string>
#include <string_view>

#include "app/result.hpp"
#include "daemon/exchange/orders.hpp"
#include "link/link_protocol.hpp"
#include "motor/drive_setup.hpp"

namespace rc10 {

/// Settings that can be written, one a line with its range; then the tool for all others.
[[nodiscard]] std::string settingsText(const DriveSetup& setup);

/// The named values of a request: settings, and `save` (1 or 0), which is required. Settings that change the
/// drive's id come last. The error says what is wrong with them.
[[nodiscard]] Result<DriveWrite> parseDriveWrite(const link::Request& request, const DriveSetup& setup);

/// Report of a write: the settings with their values, and their consequences for the client.
[[nodiscard]] std::string wordsOf(const DriveWrite& write, const DriveSetup& setup);
/// The value at which it ended.
[[nodiscard]] std::string_view settingAt(const DriveWrite& write, const DriveSetup& setup, std::size_t index);

}  // namespace rc10
