// Hours of matches, in virtual time: rc10_match --hours H --seed S [--jobs N]
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "faults/jobs.hpp"
#include "faults/match.hpp"

namespace {

using namespace rc10;
using namespace rc10::test;

// Longest list of stops that is shown.
constexpr std::size_t kMostShown = 10;

// Share of the time in which a motor that is ACTIVE and commanded follows its target: after a gap of the
// programs it waits for the next command.
constexpr double kLeastFollowed = 0.8;

struct Outcome {
  std::uint64_t seed = 0;
  std::string text;
  std::vector<std::string> nuisances;
};

void play(Duration robot_time, Outcome& out) {
  try {
    SeededChoices choices{out.seed};
    Match match{choices};
    while (match.robotTime() < robot_time) match.tick();
    out.nuisances = match.nuisances();
    out.text = match.text();
    if (const auto idlers = match.idlers(kLeastFollowed); !idlers.empty())
      out.nuisances.push_back("asked to, and did not follow their targets for most of the time:" + idlers);
  } catch (const std::exception& problem) {
    out.nuisances = {problem.what()};
  }
}

}  // namespace

int main(int argc, char** argv) {
  Jobs jobs{.hours = 0.1};
  CLI::App app{"Matches of a sound robot, in virtual time: a stop that nobody asked for is a failure"};
  jobs.addTo(app);
  CLI11_PARSE(app, argc, argv);

  const auto outcomes = jobs.run<Outcome>(play);
  long failed = 0;
  for (const auto& outcome : outcomes) {
    std::printf("seed %llu, %s", static_cast<unsigned long long>(outcome.seed), outcome.text.c_str());
    failed += outcome.nuisances.empty() ? 0 : 1;
    for (std::size_t i = 0; i < outcome.nuisances.size() && i < kMostShown; ++i)
      std::printf("FAILED seed %llu, %s\n", static_cast<unsigned long long>(outcome.seed),
                  outcome.nuisances[i].c_str());
    if (outcome.nuisances.size() > kMostShown)
      std::printf("and %zu more\n", outcome.nuisances.size() - kMostShown);
  }
  std::printf("%ld passed, %ld failed, 0 skipped\n", static_cast<long>(outcomes.size()) - failed, failed);
  return failed == 0 ? 0 : 1;
}
