#include "web/trace_store.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace rc10::web::test::trace_store_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

link::TraceSignal signal(std::uint16_t motor, std::uint16_t value = 0) {
  return {link::TraceSource::kMotor, motor, value};
}

link::TraceRow row(std::int64_t mono_us, std::initializer_list<double> values) {
  link::TraceRow out{.mono_us = mono_us, .tick = mono_us / 1000, .values = {}};
  std::copy(values.begin(), values.end(), out.values.begin());
  return out;
}

std::vector<TraceStore::Column> columnsOf(const TraceStore& store, const link::TraceSignal& wanted,
                                          std::int64_t width_us, std::int64_t first, std::size_t count) {
  std::vector<TraceStore::Column> out(count);
  store.columns(wanted, width_us, first, out);
  return out;
}

TEST(TraceStore, AColumnHasTheLeastAndTheGreatestOfItsTicks) {
  TraceStore store(100);
  store.choose(std::array{signal(0)});
  const std::array values{3.0, -1.0, 2.0, kNan, 7.0, 5.0};
  for (std::size_t i = 0; i < values.size(); ++i)
    store.add(row(10'000 + 1000 * static_cast<std::int64_t>(i), {values[i]}));
  const auto columns = columnsOf(store, signal(0), 3000, 3, 4);  // 9 to 21 ms
  EXPECT_EQ(columns[0].min, -1.0F);
  EXPECT_EQ(columns[0].max, 3.0F);
  EXPECT_EQ(columns[1].min, 2.0F);  // the NaN between is none
  EXPECT_EQ(columns[1].max, 7.0F);
  EXPECT_EQ(columns[2].min, 5.0F);
  EXPECT_TRUE(std::isnan(columns[3].min) && std::isnan(columns[3].max));
}

TEST(TraceStore, TheOldestRowsMakeWay) {
  TraceStore store(10);
  store.choose(std::array{signal(0)});
  for (std::int64_t i = 1; i <= 25; ++i) store.add(row(1000 * i, {static_cast<double>(i)}));
  EXPECT_EQ(store.oldestUs(), 16'000);
  EXPECT_EQ(store.newestUs(), 25'000);
  const auto columns = columnsOf(store, signal(0), 1000, 15, 11);
  EXPECT_TRUE(std::isnan(columns[0].min));
  for (std::size_t i = 1; i < columns.size(); ++i) EXPECT_EQ(columns[i].max, static_cast<float>(15 + i));
}

TEST(TraceStore, WhatWasSeenOfASignalStaysWhenOthersAreChosen) {
  TraceStore store(100);
  store.choose(std::array{signal(0), signal(1)});
  store.add(row(1000, {1.0, 10.0}));
  store.choose(std::array{signal(2), signal(1)});  // in another place now
  store.add(row(2000, {200.0, 20.0}));
  const auto kept = columnsOf(store, signal(1), 1000, 1, 2);
  EXPECT_EQ(kept[0].max, 10.0F);
  EXPECT_EQ(kept[1].max, 20.0F);
  const auto fresh = columnsOf(store, signal(2), 1000, 1, 2);
  EXPECT_TRUE(std::isnan(fresh[0].max));
  EXPECT_EQ(fresh[1].max, 200.0F);
  EXPECT_TRUE(std::isnan(columnsOf(store, signal(0), 1000, 1, 1)[0].max));  // not watched: no room is kept
}

TEST(TraceStore, ARowThatIsNotNewerIsNone) {
  TraceStore store(10);
  store.choose(std::array{signal(0)});
  store.add(row(2000, {1.0}));
  store.add(row(2000, {9.0}));
  store.add(row(1000, {9.0}));
  EXPECT_EQ(store.newestUs(), 2000);
  EXPECT_EQ(columnsOf(store, signal(0), 1000, 2, 1)[0].max, 1.0F);
}

TEST(TraceStore, OfARobotThatWasStartedAnewNothingIsLeft) {
  TraceStore store(10);
  store.choose(std::array{signal(0)});
  store.add(row(9000, {1.0}));
  store.clear();
  EXPECT_EQ(store.newestUs(), 0);
  store.choose(std::array{signal(0)});
  store.add(row(1000, {2.0}));
  EXPECT_EQ(store.newestUs(), 1000);
}

TEST(TraceStore, MoreSignalsThanThereIsRoomForAreLeftOut) {
  TraceStore store(4);
  std::vector<link::TraceSignal> all;
  for (std::uint16_t i = 0; i < 40; ++i) all.push_back(signal(i));
  store.choose(all);
  store.add(row(1000, {5.0}));
  EXPECT_EQ(columnsOf(store, signal(0), 1000, 1, 1)[0].max, 5.0F);
  EXPECT_TRUE(std::isnan(columnsOf(store, signal(39), 1000, 1, 1)[0].max));
}

// The same as looking at every row, for any width and place.
TEST(TraceStore, ColumnsAgreeWithAllRows) {
  std::mt19937 random{7};
  std::uniform_int_distribution<std::int64_t> gap_us{200, 4000};
  std::uniform_real_distribution<double> value{-1.0, 1.0};
  TraceStore store(300);
  store.choose(std::array{signal(0)});
  std::vector<std::pair<std::int64_t, float>> rows;
  std::int64_t now_us = 0;
  for (int i = 0; i < 1000; ++i) {
    now_us += gap_us(random);
    const double v = value(random);
    rows.emplace_back(now_us, static_cast<float>(v));
    store.add(row(now_us, {v}));
  }
  rows.erase(rows.begin(), rows.end() - 300);
  for (const std::int64_t width_us : {100, 1000, 3333, 50'000, 10'000'000}) {
    const auto first = rows.front().first / width_us - 2;
    const auto columns = columnsOf(store, signal(0), width_us, first, 500);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      float least = std::numeric_limits<float>::infinity();
      for (const auto& [at_us, v] : rows) {
        if (at_us / width_us == first + static_cast<std::int64_t>(i)) least = std::min(least, v);
      }
      if (std::isinf(least)) {
        EXPECT_TRUE(std::isnan(columns[i].min));
      } else {
        EXPECT_EQ(columns[i].min, least);
      }
    }
  }
}

}  // namespace
}  // namespace rc10::web::test::trace_store_test
