#include "daemon/clients/drive_request.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "app/nearest.hpp"

namespace rc10 {
namespace {

constexpr std::string_view kSave = "save";

std::string namesOf(const DriveSetup& setup) {
  std::vector<std::string_view> names;
  for (const auto& setting : setup.settings) names.push_back(setting.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<void> check(const DriveSetting& setting, double value) {
  if (!std::isfinite(value)) return fail(fmt::format("{} is not a finite number", setting.name));
  if (value < setting.min || value > setting.max) {
    return fail(fmt::format("{} has to be {} to {}", setting.name, setting.min, setting.max));
  }
  if (setting.integer && value != std::round(value)) {
    return fail(fmt::format("{} has to be a whole number", setting.name));
  }
  return {};
}

bool contains(const DriveWrite& write, std::size_t setting) {
  const auto values = std::span(write.values).first(write.count);
  return std::any_of(values.begin(), values.end(),
                     [setting](const DriveValue& each) { return each.setting == setting; });
}

Result<void> add(DriveWrite& write, const DriveSetup& setup, std::string_view name, double value) {
  const auto found = std::find_if(setup.settings.begin(), setup.settings.end(),
                                  [name](const DriveSetting& each) { return each.name == name; });
  if (found == setup.settings.end()) {
    std::vector<std::string_view> names;
    for (const auto& setting : setup.settings) names.push_back(setting.name);
    return fail(fmt::format("there is no setting '{}'; there are: {}{}", name, namesOf(setup),
                            didYouMean(name, names)));
  }
  if (auto sound = check(*found, value); !sound) return sound;
  const auto index = static_cast<std::size_t>(found - setup.settings.begin());
  if (contains(write, index)) return fail(fmt::format("{} is given twice", name));
  if (write.count == write.values.size()) {
    return fail(fmt::format("at most {} settings at once", write.values.size()));
  }
  write.values[write.count++] = {static_cast<std::uint8_t>(index), value};
  return {};
}

}  // namespace

std::string settingsText(const DriveSetup& setup) {
  std::string text;
  for (const auto& setting : setup.settings) {
    text += fmt::format("{} {} to {}{}\n", setting.name, setting.min, setting.max,
                        setting.integer ? ", whole" : "");
  }
  if (setup.settings.empty()) text = "nothing can be written to this drive over CAN\n";
  return text + fmt::format("everything else: {}", setup.tool.empty() ? "its maker's tool" : setup.tool);
}

Result<DriveWrite> parseDriveWrite(const link::Request& request, const DriveSetup& setup) {
  if (setup.settings.empty()) {
    return fail(fmt::format("nothing can be written to this drive over CAN: use {}",
                            setup.tool.empty() ? "its maker's tool" : setup.tool));
  }
  DriveWrite write;
  bool save_said = false;
  const auto count = std::min<std::size_t>(request.value_count, link::kMaxValues);
  for (const auto& value : std::span(request.values).first(count)) {
    if (value.name.view() == kSave) {
      save_said = value.value == 0.0 || value.value == 1.0;
      write.save = value.value == 1.0;
    } else if (auto added = add(write, setup, value.name.view(), value.value); !added) {
      return tl::unexpected(added.error());
    }
  }
  if (!save_said) return fail("`save` has to be 1 (to the drive's flash) or 0 (until it is without power)");
  if (write.count == 0) return fail(fmt::format("name a setting and its value: {}", namesOf(setup)));
  if (!write.save && setup.stores_at_once) return fail("this drive stores what it is told: save has to be 1");
  const auto identity = [&setup](const DriveValue& each) { return setup.settings[each.setting].identity; };
  const auto values = std::span(write.values).first(write.count);
  std::stable_partition(values.begin(), values.end(), [&](const auto& each) { return !identity(each); });
  if (write.count > 1 && identity(values[write.count - 2])) {
    return fail("one change of ids at a time: the drive may answer as another one after the first");
  }
  return write;
}

std::string wordsOf(const DriveWrite& write, const DriveSetup& setup) {
  std::string text;
  bool renamed = false;
  for (const auto& value : std::span(write.values).first(write.count)) {
    const auto& setting = setup.settings[value.setting];
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", setting.name, value.value);
    renamed = renamed || setting.identity;
  }
  text += write.save ? ", stored" : ", until it is without power";
  if (renamed) {
    text +=
        "; it answers as another one now or after a restart: write that into the configuration, switch "
        "the drive off and on and restart rc10d";
  }
  return text;
}

std::string_view settingAt(const DriveWrite& write, const DriveSetup& setup, std::size_t index) {
  const std::size_t setting = index < write.count ? write.values[index].setting : 0;
  return setting < setup.settings.size() ? setup.settings[setting].name : std::string_view{};
}

}  // namespace rc10
