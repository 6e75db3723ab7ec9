#include "client/module_text.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

#include "app/printable.hpp"
#include "client/json_line.hpp"
#include "client/quantity_text.hpp"

namespace rc10::client {
namespace {

std::span<const link::Name> inputs(const ModuleView& module) {
  return std::span{module.info.names}.first(
      std::min<std::size_t>(module.info.input_count, link::kMaxSignals));
}

std::span<const link::Name> outputs(const ModuleView& module) {
  const auto first = inputs(module).size();
  return std::span{module.info.names}.subspan(
      first, std::min<std::size_t>(module.info.output_count, link::kMaxSignals));
}

std::string joined(std::span<const link::Name> names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : " ") + printable(name.view());
  return text.empty() ? "none" : text;
}

// Mouse and keys of a remote at rest: dozens, which would hide the rest of the line.
bool untouched(const ModuleView& module, std::string_view name, double value) {
  return module.info.type.view() == "remote" && (name.starts_with("key_") || name.starts_with("mouse_")) &&
         !(std::abs(value) > 0.0);
}

}  // namespace

std::string modulesText(const std::vector<ModuleView>& modules) {
  if (modules.empty()) return "this robot has no modules: see `modules:` in docs/modules.md\n";
  std::string text;
  for (const auto& module : modules) {
    const auto owner = module.state.owner.view();
    text += (text.empty() ? "" : "\n") + printable(module.name.view()) + ": " +
            printable(module.info.type.view()) + ", " +
            (owner.empty() ? "commanded by nobody" : "commanded by '" + printable(owner) + "'") + "\n";
    text += "  inputs: " + joined(inputs(module)) + "\n";
    const auto names = outputs(module);
    for (std::size_t i = 0; i < names.size(); ++i) {
      text += "  " + printable(names[i].view()) + " = " + number(module.state.values[i], 3) + "\n";
    }
  }
  return text;
}

std::string moduleLines(const std::vector<ModuleView>& modules) {
  std::string text;
  for (const auto& module : modules) {
    const auto owner = module.state.owner.view();
    text += "module " + printable(module.name.view()) + " (" + printable(module.info.type.view()) + ")  ";
    if (!inputs(module).empty())
      text += owner.empty() ? "commanded by nobody  " : "commanded by '" + printable(owner) + "'  ";
    const auto names = outputs(module);
    std::string_view gap;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double value = module.state.values[i];
      if (untouched(module, names[i].view(), value)) continue;
      text += std::string{gap} + printable(names[i].view()) + " " + number(value, 2);
      gap = "  ";
    }
    text += '\n';
  }
  return text;
}

std::string modulesJson(const std::vector<ModuleView>& modules) {
  Json all = Json::array();
  for (const auto& module : modules) {
    Json in = Json::array();
    for (const auto& name : inputs(module)) in.push_back(name.view());
    Json out = Json::object();
    const auto names = outputs(module);
    for (std::size_t i = 0; i < names.size(); ++i) out[std::string(names[i].view())] = module.state.values[i];
    all.push_back({{"name", module.name.view()},
                   {"type", module.info.type.view()},
                   {"owner", module.state.owner.view()},
                   {"tick", module.state.tick},
                   {"inputs", in},
                   {"outputs", out}});
  }
  return lineOf({{"modules", all}});
}

}  // namespace rc10::client
