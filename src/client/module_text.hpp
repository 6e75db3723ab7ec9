#pragma once

#include <string>
#include <vector>

#include "link/link_protocol.hpp"

namespace rc10::client {

/// A module as a client knows it. Without a state, the state's tick is 0.
struct ModuleView {
  link::Name name;
  link::ModuleInfo info;
  link::ModuleState state;
};

/// For people: each module with its type, who gives its inputs, what they are, and its outputs with their
/// values.
[[nodiscard]] std::string modulesText(const std::vector<ModuleView>& modules);

/// A line for each: who commands it, and its outputs; mouse and keys of a remote while they are not 0.
[[nodiscard]] std::string moduleLines(const std::vector<ModuleView>& modules);

/// The same as one line of JSON. An output without meaning is null.
[[nodiscard]] std::string modulesJson(const std::vector<ModuleView>& modules);

}  // namespace rc10::client
