// Sequences of commands, orders, faults and feedback to a whole robot on simulated motors, judged after every
// tick: tests/faults.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "faults/chaos.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rc10::test::BytesOfChoices choices({data, size});
  rc10::test::Chaos chaos{choices};
  try {
    // Inputs that go on for long find no more than several of them.
    while (!choices.over() && chaos.ticks() < 3'000) chaos.step();
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n%s", problem.what(), chaos.history().c_str());
    std::abort();
  }
  return 0;
}
