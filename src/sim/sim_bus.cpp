#include "sim/sim_bus.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rc10::sim {
namespace {

/// Uniform in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random) noexcept { return static_cast<double>(random() >> 11U) * 0x1p-53; }

bool wouldCollide(const Drive& a, const Drive& b) noexcept {
  return std::any_of(a.sends().begin(), a.sends().end(), [&](const FrameFilter& one) {
    return std::any_of(b.sends().begin(), b.sends().end(),
                       [&](const FrameFilter& other) { return overlaps(one, other); });
  });
}

}  // namespace

Result<void> SimBus::check(const SimBusConfig& config) {
  std::vector<std::unique_ptr<Drive>> drives;
  for (const auto& recipe : config.drives) {
    auto made = recipe();
    if (!made) return tl::unexpected(made.error());
    const Drive& drive = **made;
    for (const auto& other : drives) {
      if (other->name() == drive.name()) {
        return fail("simulated motor '" + drive.name() + "' exists twice on its bus; names are unique");
      }
      if (!wouldCollide(*other, drive)) continue;
      return fail("simulated motors '" + other->name() + "' and '" + drive.name() +
                  "' would both send the feedback of one id: give one of them another id or bus");
    }
    drives.push_back(std::move(*made));
  }
  return {};
}

SimBus::SimBus(const SimBusConfig& config) {
  nodes_.reserve(config.drives.size());
  for (const auto& recipe : config.drives) {
    std::seed_seq seed{static_cast<std::uint32_t>(config.seed),
                       static_cast<std::uint32_t>(config.seed >> 32U),
                       static_cast<std::uint32_t>(nodes_.size())};
    std::mt19937_64 random{seed};
    const auto phase_ns = uniform(random) * static_cast<double>(config.phase_spread.count());
    auto drive = std::move(recipe().value());
    const Duration first = drive->feedbackPeriod() + Duration{std::llround(phase_ns)};
    const std::size_t place = nodes_.size();
    const MotorLoad load = drive->load();
    nodes_.push_back({.drive = std::move(drive),
                      .random = random,
                      .next_feedback = first,
                      .at_start = load,
                      .plan = place < config.plans.size() ? config.plans[place] : LoadPlan{}});
  }
}

void SimBus::receive(const CanFrame& command) noexcept {
  for (Node& node : nodes_) node.drive->receive(command);
}

std::size_t SimBus::step(MonotonicTime now, Duration dt, std::span<CanFrame> out) noexcept {
  elapsed_ += std::max(dt, Duration::zero());
  std::size_t count = 0;
  std::array<CanFrame, Drive::kMaxFrames> frames;
  for (Node& node : nodes_) {
    giveOut(node, std::span(frames).first(node.drive->answers(frames)), now, out, count);
    followPlan(node);
    node.drive->step(dt);
    if (!isDue(node)) continue;
    giveOut(node, std::span(frames).first(node.drive->feedback(frames)), now, out, count);
  }
  return count;
}

// A change counts from the begin of the step in which it is due.
void SimBus::followPlan(Node& node) const noexcept {
  const auto& [steps, repeat] = node.plan;
  const auto change = [&](const LoadChange& by) {
    node.drive->setLoad(by.of(node.drive->load(), node.at_start));
  };
  while (!steps.empty()) {
    const bool over = node.next_change == steps.size();
    if (over && repeat <= Duration::zero()) return;
    const Duration due = node.plan_begun + (over ? repeat : steps[node.next_change].after);
    if (elapsed_ < due) return;
    change(over ? LoadChange{.back = true} : steps[node.next_change].change);
    node.plan_begun = over ? due : node.plan_begun;
    node.next_change = over ? 0 : node.next_change + 1;
  }
}

void SimBus::giveOut(Node& node, std::span<const CanFrame> frames, MonotonicTime now, std::span<CanFrame> out,
                     std::size_t& count) noexcept {
  for (const CanFrame& frame : frames) {
    if (losesFrame(node)) {
      ++counters_.lost;
    } else if (count == out.size()) {
      ++counters_.overflowed;
    } else {
      out[count] = frame;
      out[count].received = now;
      ++count;
      ++counters_.feedback;
    }
  }
}

bool SimBus::isDue(Node& node) noexcept {
  // Up to half a period early counts as due: steps of one period that come a little early or late then give
  // one frame each.
  const Duration period = node.drive->feedbackPeriod();
  if (period <= Duration::zero()) return false;
  const Duration late = elapsed_ - node.next_feedback;
  if (late < -period / 2) return false;
  const auto missed = std::max(late, Duration::zero()) / period;
  node.next_feedback += (missed + 1) * period;
  counters_.overslept += static_cast<std::uint64_t>(missed);
  return true;
}

bool SimBus::losesFrame(Node& node) noexcept {
  const MotorLoad& load = node.drive->load();
  // Drawn for every frame, so that a fault that comes and goes leaves the rest of the run as it was.
  const bool lost = uniform(node.random) < static_cast<double>(load.lost_frames);
  return lost || load.silent;
}

std::optional<std::size_t> SimBus::indexOf(std::string_view name) const noexcept {
  const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                  [name](const Node& node) { return node.drive->name() == name; });
  if (found == nodes_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - nodes_.begin());
}

void SimBus::setLoad(std::size_t index, const MotorLoad& load) noexcept {
  nodes_[index].drive->setLoad(load);
}

void SimBus::changeLoad(std::size_t index, const LoadChange& change) noexcept {
  Node& node = nodes_[index];
  node.drive->setLoad(change.of(node.drive->load(), node.at_start));
}

template <typename T>
void SimBus::change(std::size_t index, T MotorLoad::*field, T value) noexcept {
  MotorLoad load = nodes_[index].drive->load();
  load.*field = value;
  nodes_[index].drive->setLoad(load);
}

void SimBus::stall(std::size_t index, bool stalled) noexcept { change(index, &MotorLoad::stalled, stalled); }

void SimBus::silence(std::size_t index, bool silent) noexcept { change(index, &MotorLoad::silent, silent); }

void SimBus::loseFrames(std::size_t index, float fraction) noexcept {
  change(index, &MotorLoad::lost_frames, std::clamp(fraction, 0.0F, 1.0F));
}

void SimBus::setTemperature(std::size_t index, double temperature_c) noexcept {
  nodes_[index].drive->physics().setTemperature(temperature_c);
}

void SimBus::turnByHand(std::size_t index, const Hand& hand) noexcept {
  nodes_[index].drive->physics().take(hand);
}

void SimBus::setEncoderFault(std::size_t index, const Drive::EncoderFault& fault) noexcept {
  nodes_[index].drive->setEncoderFault(fault);
}

}  // namespace rc10::sim
