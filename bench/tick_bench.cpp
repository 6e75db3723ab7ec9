// Cost of a tick, for fleets of different size: see docs/performance.md. bench/table runs this program
// and turns its figures into cost per frame and per motor.
//   tick_bench [Google Benchmark's options]
//   tick_bench --ticks N FLEET     N whole ticks and nothing else, for counting instructions from outside
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "app/subnormals.hpp"
#include "fleet.hpp"

namespace rc10::bench {
namespace {

// Which part of a millisecond is measured. Each holds the one before it: the table subtracts.
struct Part {
  const char* name;
  void (*run)(Fleet&);
};

void prepare(Fleet& fleet) { fleet.advance(); }

void receive(Fleet& fleet) {
  prepare(fleet);
  fleet.deliver();
  fleet.receive();
}

void control(Fleet& fleet) {
  receive(fleet);
  fleet.control();
}

void wholeTick(Fleet& fleet) {
  prepare(fleet);
  fleet.deliver();
  fleet.tick();
}

void commandedTick(Fleet& fleet) {
  fleet.command();
  wholeTick(fleet);
}

constexpr std::array<Part, 5> kParts{{
    {"prepare", prepare},
    {"receive", receive},
    {"control", control},
    {"tick", wholeTick},
    {"commanded_tick", commandedTick},
}};

void measure(benchmark::State& state, const Shape& shape, const Part& part) {
  const auto fleet = std::make_unique<Fleet>(shape);
  const bool whole = part.run == wholeTick || part.run == commandedTick;
  if (!fleet->start(whole ? wholeTick : control)) {
    state.SkipWithError("not every motor obeys");
    return;
  }
  for (auto _ : state) part.run(*fleet);
  if (fleet->droppedFrames() != 0) state.SkipWithError("frames were lost");
  state.counters["motors"] = static_cast<double>(shape.motors());
}

int runTicks(std::uint64_t ticks, std::string_view name) {
  const auto* const shape =
      std::find_if(kShapes.begin(), kShapes.end(), [name](const Shape& s) { return s.name == name; });
  if (shape == kShapes.end()) {
    std::fprintf(stderr, "tick_bench: no such fleet\n");
    return 2;
  }
  const auto fleet = std::make_unique<Fleet>(*shape);
  if (!fleet->start(wholeTick)) return 1;
  for (std::uint64_t i = 0; i < ticks; ++i) wholeTick(*fleet);
  return 0;
}

}  // namespace
}  // namespace rc10::bench

int main(int argc, char** argv) {
  using namespace rc10::bench;
  rc10::flushSubnormals();  // as the scheduler's thread
  if (argc == 4 && std::string_view(argv[1]) == "--ticks") {
    return runTicks(std::strtoull(argv[2], nullptr, 10), argv[3]);
  }
  for (const auto& part : kParts) {
    for (const auto& shape : kShapes) {
      benchmark::RegisterBenchmark((std::string(part.name) + "/" + std::string(shape.name)).c_str(),
                                   [&](benchmark::State& state) { measure(state, shape, part); });
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
