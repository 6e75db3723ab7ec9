#include "guard/watched_robot.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "bus/frame_text.hpp"
#include "link/guard_hello.hpp"

namespace rc10::guard {

Result<WatchedRobot> WatchedRobot::from(link::DescriptorMessage message) {
  const auto hello = link::parseGuardHello(message.text);
  if (!hello) return tl::unexpected(hello.error());
  if (message.descriptors.size() != 2)
    return fail(
        "the hello of rc10d came without its two descriptors: other versions, or no file descriptors left "
        "(LimitNOFILE= of the unit, `ulimit -n`)");
  auto page = link::SharedGuardPage::map(std::move(message.descriptors[0]));
  if (!page) return tl::unexpected(page.error());
  const auto frames = parseFrameList(hello->rest_frames);
  if (!frames) return fail("rest frames of robot '" + hello->robot + "': " + frames.error().message);
  std::map<std::string, std::vector<CanFrame>> by_interface;
  for (const auto& [interface, frame] : *frames) by_interface[interface].push_back(frame);
  std::vector<BusRest> buses;
  for (auto& [interface, of_bus] : by_interface) {
    auto& bus = buses.emplace_back(interface, std::move(of_bus));
    if (auto opened = bus.open(); !opened) return tl::unexpected(opened.error());
  }
  return WatchedRobot{hello->robot, hello->standstill_ms, std::move(*page), std::move(message.descriptors[1]),
                      std::move(buses)};
}

WatchedRobot::WatchedRobot(std::string robot, std::uint32_t standstill_ms, link::SharedGuardPage page,
                           UniqueFd process, std::vector<BusRest> buses)
    : robot_(std::move(robot)),
      standstill_(standstill_ms),
      page_(std::move(page)),
      process_(std::move(process)),
      buses_(std::move(buses)) {}

void WatchedRobot::handOver(const WatchedRobot& to) {
  std::erase_if(buses_, [&to](BusRest& ours) {
    return std::any_of(to.buses_.begin(), to.buses_.end(), [&ours](const BusRest& theirs) {
      return theirs.interface() == ours.interface() && !ours.leaveTo(theirs);
    });
  });
  over_ = over_ || buses_.empty();
}

std::string WatchedRobot::step(bool ended) {
  if (over_) return {};
  page_->beats.fetch_add(1, std::memory_order_relaxed);
  const bool dies = ended && !dead_;
  dead_ = dead_ || ended;
  // Read after the death: what rc10d wrote before it counts.
  const auto ticks = page_->ticks.load(std::memory_order_acquire);
  const bool at_rest = page_->ended.load(std::memory_order_acquire);
  if (dead_ && (at_rest || (!resting_ && ticks == 0))) {
    over_ = true;
    return {};
  }
  if (at_rest) {
    resting_ = false;
    return {};
  }
  const bool still = standstill_.step(ticks);
  // It may have gone on for a frame since it was told to rest.
  if (dead_ && (!resting_ || dies)) return begin("rc10d has died");
  if (!resting_ && still) return begin("the ticks of rc10d stand still");
  if (resting_ && !dead_ && !still) {
    // It goes on, and enters its e-stop: it sees `acted`.
    resting_ = false;
    return "robot '" + robot_ + "': rc10d ticks again";
  }
  return resting_ ? send() : std::string{};
}

std::string WatchedRobot::begin(const std::string& why) {
  page_->acted.store(true, std::memory_order_release);
  resting_ = true;
  rested_ = false;
  rest_steps_ = 0;
  for (auto& bus : buses_) {
    bus.begin();
    bus.step();
  }
  return "robot '" + robot_ + "': " + why + ": its drives are told to rest";
}

std::string WatchedRobot::send() {
  for (auto& bus : buses_) bus.step();
  ++rest_steps_;
  const bool done = std::all_of(buses_.begin(), buses_.end(), [](const auto& bus) { return bus.done(); });
  const bool given_up = !done && rest_steps_ >= kLongestRestSteps;
  if (!rested_ && (done || given_up)) {
    rested_ = true;
    if (dead_) over_ = true;
    return "robot '" + robot_ + "': " +
           (done ? "the rest frames are on the wire"
                 : "no bus has carried the rest frames for ten minutes; given up");
  }
  if (rested_ && dead_) over_ = true;
  return {};
}

}  // namespace rc10::guard
