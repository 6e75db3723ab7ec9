// Hours of robot time full of random faults: rc10_soak --hours H --seed S [--jobs N]
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>

#include "faults/chaos.hpp"
#include "faults/jobs.hpp"

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
  Jobs jobs{.hours = 1.0};
  CLI::App app{"Soak of the whole tick on simulated motors, in virtual time"};
  jobs.addTo(app);
  CLI11_PARSE(app, argc, argv);

  const auto begin = std::chrono::steady_clock::now();
  const auto outcomes = jobs.run<Outcome>(soak);
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
  std::uint64_t active = 0;
  for (const auto& [name, visited] : all.motors) active += visited.active;
  if (active == 0) {
    ++failed;
    std::printf("FAILED no motor was ever ACTIVE, so that nothing was judged\n");
  }
  // Five minutes reach most rules, and an hour each of them, whatever the seed.
  constexpr double kShort_h = 0.08;
  const auto idle = jobs.hours >= 1.0 ? all.idleInAnHour() : jobs.hours >= kShort_h ? all.idle() : "";
  if (!idle.empty()) {
    ++failed;
    std::printf("FAILED never seen, so that nothing was judged: %s\n", idle.c_str());
  }
  std::printf("%ld passed, %ld failed, 0 skipped\n",
              std::max(static_cast<long>(outcomes.size()) - failed, 0L), failed);
  return failed == 0 ? 0 : 1;
}
