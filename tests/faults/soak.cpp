// Hours of robot time full of random faults: rc10_soak --hours H --seed S [--jobs N]
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "faults/chaos.hpp"

namespace {

using namespace rc10;
using namespace rc10::test;

struct Outcome {
  std::uint64_t seed = 0;
  Visits visits;
  std::string actions;
  std::string problem;  ///< Empty: none.
};

void soak(Duration robot_time, Outcome& out) {
  SeededChoices choices{out.seed};
  Chaos chaos{choices};
  try {
    while (chaos.robotTime() < robot_time) chaos.step();
  } catch (const std::exception& problem) {
    out.problem = std::string{problem.what()} + "\n" + chaos.history();
  }
  out.visits = chaos.visits();
  out.actions = chaos.actionsText();
}

}  // namespace

int main(int argc, char** argv) {
  double hours = 1.0;
  std::uint64_t seed = 1;
  unsigned jobs = 1;
  CLI::App app{"Soak of the whole tick on simulated motors, in virtual time"};
  app.add_option("--hours", hours, "of robot time")->check(CLI::PositiveNumber);
  app.add_option("--seed", seed, "of the first job; the others count on");
  app.add_option("--jobs", jobs, "share the hours, each with a seed of its own")->check(CLI::Range(1, 64));
  CLI11_PARSE(app, argc, argv);

  const auto share =
      std::chrono::duration_cast<Duration>(std::chrono::duration<double>(hours * 3600.0 / jobs));
  std::vector<Outcome> outcomes(jobs);
  std::vector<std::thread> threads;
  const auto begin = std::chrono::steady_clock::now();
  for (unsigned i = 0; i < jobs; ++i) {
    outcomes[i].seed = seed + i;
    threads.emplace_back([share, &outcome = outcomes[i]] { soak(share, outcome); });
  }
  for (auto& thread : threads) thread.join();
  const auto wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  Visits all;
  long failed = 0;
  for (const auto& outcome : outcomes) {
    all.add(outcome.visits);
    std::printf("seed %llu, %llu ticks, %s", static_cast<unsigned long long>(outcome.seed),
                static_cast<unsigned long long>(outcome.visits.ticks), outcome.actions.c_str());
    if (outcome.problem.empty()) continue;
    ++failed;
    std::printf("FAILED seed %llu: %s", static_cast<unsigned long long>(outcome.seed),
                outcome.problem.c_str());
  }
  std::printf("%s%llu ticks in %.1f s, %.0f a second\n", all.text().c_str(),
              static_cast<unsigned long long>(all.ticks), wall_s, static_cast<double>(all.ticks) / wall_s);
  // An hour reaches every motor, whatever the seed.
  if (const auto idle = all.idle(); hours >= 1.0 && !idle.empty()) {
    ++failed;
    std::printf("FAILED never moved, so that nothing was judged: %s\n", idle.c_str());
  }
  std::printf("%ld passed, %ld failed, 0 skipped\n", std::max(static_cast<long>(jobs) - failed, 0L), failed);
  return failed == 0 ? 0 : 1;
}
