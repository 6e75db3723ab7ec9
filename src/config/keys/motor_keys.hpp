#pragma once

#include <string_view>

#include "config/keys/key_table.hpp"
#include "motor/own_key.hpp"

namespace rc10 {

/// A key of one family, as the tables have it. Whether it is required, the family asks by itself.
[[nodiscard]] Key motorKeyOf(const OwnKey& key);

/// Whether every motor has this key, whatever its family.
[[nodiscard]] bool isCommonMotorKey(std::string_view name);

/// Whether the keys of a motor have been put together: from then on no family can be added.
[[nodiscard]] bool motorKeysMade() noexcept;

}  // namespace rc10
