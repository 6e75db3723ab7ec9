#pragma once

#include <string>

namespace rc10 {

/// JSON Schema (2020-12) of the configuration, made from the key tables: editors complete keys, show
/// their descriptions and underline mistakes. config/rc10d.schema.json is this text.
[[nodiscard]] std::string configSchema();

}  // namespace rc10
