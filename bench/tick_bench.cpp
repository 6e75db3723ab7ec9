// Cost of a tick, for fleets of different size: see docs/performance.md. bench/table runs this program
// and turns its figures into cost per frame and per motor.
//   tick_bench [Google Benchmark's options]
//   tick_bench --ticks N FLEET [full]
//       N whole ticks and nothing else, for counting instructions from outside
//       full: each with as many frames and setpoints as a tick takes
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "app/subnormals.hpp"
#include "bus/can_receiver.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/interfaces/can_intake.hpp"
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

// Frames of one bus that a drain takes.
constexpr std::size_t kFramesPerTick = CanIntake::kMaxReads * CanReceiver::kBatch;

// A flood on each bus, and clients that ask for all that a tick carries out.
void fullTick(Fleet& fleet) {
  prepare(fleet);
  for (std::size_t frames = 0; frames < kFramesPerTick; frames += fleet.framesPerBus()) fleet.deliver();
  for (std::size_t setpoints = 0; setpoints < kSetpointsPerTick; setpoints += fleet.motors()) fleet.command();
  fleet.tick();
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

int runTicks(std::uint64_t ticks, std::string_view name, void (*one_tick)(Fleet&)) {
  const auto* const shape =
      std::find_if(kShapes.begin(), kShapes.end(), [name](const Shape& s) { return s.name == name; });
  if (shape == kShapes.end()) {
    std::fprintf(stderr, "tick_bench: no such fleet\n");
    return 2;
  }
  const auto fleet = std::make_unique<Fleet>(*shape);
  if (!fleet->start(wholeTick)) return 1;
  for (std::uint64_t i = 0; i < ticks; ++i) one_tick(*fleet);
  return fleet->droppedFrames() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace rc10::bench

int main(int argc, char** argv) {
  using namespace rc10::bench;
  rc10::flushSubnormals();  // as the scheduler's thread
  const bool full = argc == 5 && std::string_view(argv[4]) == "full";
  if ((argc == 4 || full) && std::string_view(argv[1]) == "--ticks") {
    return runTicks(std::strtoull(argv[2], nullptr, 10), argv[3], full ? fullTick : wholeTick);
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
