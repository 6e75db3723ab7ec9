#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/time.hpp"

namespace rc10::test {

/// Hours of robot time, shared by threads that each have a seed of their own: --hours H --seed S [--jobs N]
struct Jobs {
  double hours;
  std::uint64_t seed = 1;
  unsigned jobs = 1;

  void addTo(CLI::App& app) {
    app.add_option("--hours", hours, "of robot time")->check(CLI::PositiveNumber);
    app.add_option("--seed", seed, "of the first job; the others count on");
    app.add_option("--jobs", jobs, "share the hours, each with a seed of its own")->check(CLI::Range(1, 64));
  }

  /// One outcome per job. `judge(robot_time, outcome)` runs in a thread of its own; Outcome has a `seed`.
  template <typename Outcome, typename Judge>
  [[nodiscard]] std::vector<Outcome> run(const Judge& judge) const {
    const auto share =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(hours * 3600.0 / jobs));
    std::vector<Outcome> outcomes(jobs);
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < jobs; ++i) {
      outcomes[i].seed = seed + i;
      threads.emplace_back([share, &judge, &outcome = outcomes[i]] { judge(share, outcome); });
    }
    for (auto& thread : threads) thread.join();
    return outcomes;
  }
};

}  // namespace rc10::test
