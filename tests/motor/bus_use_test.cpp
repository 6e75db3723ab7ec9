#include "motor/bus_use.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "drives/families.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::bus_use_test {
namespace {

/// All frames of the one are frames of the other.
bool within(const FrameFilter& narrow, const FrameFilter& wide) {
  if (narrow.id.extended != wide.id.extended) return false;
  const std::uint32_t wanted = wide.mask & idMask(wide.id.extended);
  if ((wanted & ~narrow.mask) != 0 || ((narrow.id.value ^ wide.id.value) & wanted) != 0) return false;
  return std::all_of(wide.discriminators.begin(), wide.discriminators.end(), [&narrow](const auto& byte) {
    return !byte ||
           std::any_of(narrow.discriminators.begin(), narrow.discriminators.end(), [&byte](const auto& own) {
             return own && own->byte_index == byte->byte_index && (byte->mask & ~own->mask) == 0 &&
                    ((own->value ^ byte->value) & byte->mask) == 0;
           });
  });
}

bool withinAny(const FrameFilter& narrow, const std::vector<FrameFilter>& wide) {
  return std::any_of(wide.begin(), wide.end(),
                     [&narrow](const FrameFilter& filter) { return within(narrow, filter); });
}

bool anyHasId(const std::vector<FrameFilter>& filters, CanId id) {
  return std::any_of(filters.begin(), filters.end(), [id](FrameFilter filter) {
    filter.discriminators = {};
    return within({.id = id}, filter);
  });
}

std::string textOf(const FrameFilter& filter) {
  return describe(filter.id) + " with mask " + std::to_string(filter.mask);
}

/// All models of all families: with the defaults all of their ids, else the ends. Ids only shift bits.
void eachUse(const std::function<void(const BusUse&)>& look) {
  for (const auto& entry : builtInFamilies()) {
    for (const auto model : entry.family->models()) {
      const auto traits = entry.family->traits(model, ownDefaults(*entry.family));
      bool looked = false;
      for (int id = traits.min_id; id <= traits.max_id; ++id) {
        auto all = variants(*entry.family, model, id);
        if (id != traits.min_id && id != traits.max_id) all.resize(std::min<std::size_t>(all.size(), 1));
        for (const MotorSettings& settings : all) {
          SCOPED_TRACE(std::string{model} + " with id " + std::to_string(id));
          look(entry.family->busUse(settings));
          looked = true;
          if (::testing::Test::HasFailure()) return;  // one says it
        }
      }
      EXPECT_TRUE(looked) << model;
    }
  }
}

TEST(BusUse, WhatSteersADriveIsAmongWhatItObeys) {
  eachUse([](const BusUse& use) {
    for (const auto& filter : use.steering()) EXPECT_TRUE(withinAny(filter, use.obeys)) << textOf(filter);
  });
}

// A stranger's frame is compared with all of them, in the tick, for each motor of its bus.
TEST(BusUse, ADriveObeysFewRangesOfIds) {
  eachUse([](const BusUse& use) {
    EXPECT_FALSE(use.obeys.empty());
    EXPECT_LE(use.obeys.size(), 6U);
  });
}

TEST(BusUse, CommandsHaveIdsThatTheDriveObeysAndFeedbackThoseThatItSends) {
  eachUse([](const BusUse& use) {
    for (const auto& command : use.commands)
      EXPECT_TRUE(anyHasId(use.obeys, command.id)) << describe(command.id);
    for (const auto& answer : use.feedback)
      EXPECT_TRUE(anyHasId(use.sends, answer.id)) << describe(answer.id);
  });
}

}  // namespace
}  // namespace rc10::test::bus_use_test
