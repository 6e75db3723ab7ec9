#include "module/module_base.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/nearest.hpp"

namespace rc10 {

Module_Base::Module_Base(ModuleSignals signals)
    : signals_(std::move(signals)),
      inputs_(signals_.inputs.size(), kNoSignal),
      outputs_(signals_.outputs.size(), kNoSignal) {}

Result<void> Module_Base::connect(const ModuleDirectory&) { return {}; }

void Module_Base::setInputs(std::span<const double> values) noexcept {
  const std::size_t count = std::min(values.size(), inputs_.size());
  std::copy_n(values.begin(), count, inputs_.begin());
  commanded_ = true;
}

void Module_Base::clearInputs() noexcept {
  std::fill(inputs_.begin(), inputs_.end(), kNoSignal);
  commanded_ = false;
}

Result<SignalPlace> ModuleDirectory::find(std::string_view name,
                                          std::vector<std::string> ModuleSignals::*kind,
                                          const std::string& what) const {
  const auto dot = std::min(name.find('.'), name.size());
  const auto module_name = name.substr(0, dot);
  const auto signal_name = name.substr(std::min(dot + 1, name.size()));
  const auto listed = [](std::string& list, std::string_view word) {
    list += (list.empty() ? "" : ", ") + std::string{word};
  };
  std::string known;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    listed(known, entries_[i].name);
    if (entries_[i].name != module_name) continue;
    const auto& signals = entries_[i].module->signals().*kind;
    std::string names;
    for (std::size_t signal = 0; signal < signals.size(); ++signal) {
      if (signals[signal] == signal_name) return SignalPlace{.module = i, .signal = signal};
      listed(names, signals[signal]);
    }
    return fail("module '" + std::string{module_name} + "' has no " + what + " '" + std::string{signal_name} +
                (names.empty() ? "'; it has none" : "'; it has " + names) +
                didYouMean(signal_name, {signals.begin(), signals.end()}));
  }
  std::vector<std::string_view> modules;
  modules.reserve(entries_.size());
  for (const auto& entry : entries_) modules.emplace_back(entry.name);
  return fail("there is no module '" + std::string{module_name} + "'; there are " + known +
              didYouMean(module_name, modules));
}

}  // namespace rc10
