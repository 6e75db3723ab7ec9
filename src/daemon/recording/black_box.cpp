#include "daemon/recording/black_box.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "blackbox/copies.hpp"
#include "blackbox/file_bytes.hpp"
#include "blackbox/image.hpp"
#include "blackbox/places.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "rc10_version.hpp"

namespace rc10 {
namespace {

// Copies kept of each robot: 160 MiB with files of the default size.
constexpr std::size_t kCopiesKept = 10;
constexpr Duration kCopyLookInterval = std::chrono::milliseconds{50};

[[nodiscard]] blackbox::Header headerOf(const RobotDescription& robot) {
  blackbox::Header header;
  header.pid = ::getpid();
  header.start_mono_ns = monotonicNow().time_since_epoch().count();
  header.rate_hz = static_cast<std::uint32_t>(robot.rate_hz);
  header.robot = robot.robot;
  header.program_version = rc10::kVersion;
  header.config_hash = robot.config_hash;
  header.bus_count = static_cast<std::uint32_t>(robot.buses.size());
  header.motor_count = static_cast<std::uint32_t>(robot.motors.size());
  for (std::size_t i = 0; i < robot.buses.size(); ++i) {
    header.buses[i].name = robot.buses[i].name;
    header.buses[i].interface = robot.buses[i].interface;
  }
  for (std::size_t i = 0; i < robot.motors.size(); ++i) {
    header.motors[i].name = robot.motors[i].name;
    header.motors[i].model = robot.motors[i].model;
    header.motors[i].bus = static_cast<std::uint32_t>(robot.motors[i].bus);
  }
  header.module_count = static_cast<std::uint32_t>(robot.modules.size());
  for (std::size_t i = 0; i < robot.modules.size(); ++i) {
    auto& module = header.modules[i];
    const auto& inputs = robot.modules[i].signals.inputs;
    module.name = robot.modules[i].name;
    module.input_count = static_cast<std::uint32_t>(inputs.size());
    for (std::size_t input = 0; input < inputs.size(); ++input) module.inputs[input] = inputs[input];
    const auto& events = robot.modules[i].signals.events;
    module.event_count = static_cast<std::uint32_t>(std::min(events.size(), module.events.size()));
    for (std::size_t event = 0; event < module.event_count; ++event)
      module.events[event] = events[event].text;
  }
  return header;
}

// Whether this is the recording of a run that did not end as it should.
[[nodiscard]] bool isOfACrash(const std::string& path) {
  const UniqueFd fd{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  blackbox::FileHead head;
  return fd && blackbox::readAll(fd.get(), 0, {reinterpret_cast<std::byte*>(&head), sizeof head}) &&
         blackbox::checkHeader(head.header) && head.control.ended == 0 && head.control.head > 0;
}

}  // namespace

Result<std::unique_ptr<BlackBox>> BlackBox::create(const Settings& settings, const RobotDescription& robot,
                                                   std::shared_ptr<spdlog::logger> log) {
  const auto path = blackbox::livePath(settings.run_dir, robot.robot);
  // Only a rename: the robot is to be back soon, and the disk may be slow.
  if (isOfACrash(path)) (void)::rename(path.c_str(), (path + ".crashed").c_str());
  auto file =
      blackbox::BoxFile::create(path, headerOf(robot), static_cast<std::uint64_t>(settings.mib) << 20U);
  if (!file) return tl::unexpected(file.error());
  return std::unique_ptr<BlackBox>(new BlackBox(settings, robot.robot, std::move(*file), std::move(log)));
}

BlackBox::BlackBox(const Settings& settings, std::string robot, std::unique_ptr<blackbox::BoxFile> file,
                   std::shared_ptr<spdlog::logger> log)
    : robot_(std::move(robot)),
      state_dir_(settings.state_dir),
      file_(std::move(file)),
      history_(file_->head(), file_->ring(), file_->descriptor()),
      recorder_(blackbox::HandOff{file_->head().control, file_->ring()}),
      log_(std::move(log)) {
  drain();  // the clock, into the file
}

void BlackBox::drain() {
  if (!file_whole_) {
    (void)history_.drain();  // nothing is kept; the hand-off goes on
    return;
  }
  if (!file_->whole()) {
    file_whole_ = false;
    history_.giveUp();
    log_->warn("somebody has cut off {}: nothing is recorded from now on. Restart rc10d to record again",
               file_->path());
    return;
  }
  std::atomic_ref(file_->head().control.wall_offset_ns)
      .store(realtimeOffset(monotonicNow()).count(), std::memory_order_relaxed);
  auto stored = history_.drain();
  if (stored) stored = file_->publish();
  if (stored || std::exchange(history_lost_, true)) return;
  log_->warn("the black box has no history from now on: {}: {}", file_->path(), stored.error().message);
}

void BlackBox::runCopies(const std::stop_token& stop) {
  copyAside();
  while (!stop.stop_requested()) {
    const auto now = monotonicNow();
    plan_.note(recorder_.takeCauses(), now);
    if (const char* cause = plan_.due(now)) copy(cause);
    std::this_thread::sleep_for(kCopyLookInterval);
  }
  plan_.note(recorder_.takeCauses(), monotonicNow());
  if (const char* cause = plan_.last(monotonicNow())) copy(cause);
}

void BlackBox::copyAside() {
  const UniqueFd fd{::open(asidePath().c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat info {};
  if (!fd || ::fstat(fd.get(), &info) != 0) return;
  // The io thread wrote to it last: that is when it crashed.
  auto path = blackbox::keepCopy(fd.get(), state_dir_, robot_, info.st_mtim.tv_sec, "crash");
  if (!path) {
    complain("the black box of the last run, which ended without stopping, stays in " + asidePath() + ": " +
             path.error().message);
    return;
  }
  (void)::unlink(asidePath().c_str());
  blackbox::removeOldCopies(state_dir_, robot_, kCopiesKept);
  log_->warn("the last run ended without stopping: its black box is in {}", *path);
}

void BlackBox::copy(const char* cause) {
  if (!file_->whole()) return;  // told by drain()
  auto path = blackbox::keepCopy(file_->descriptor(), state_dir_, robot_, wallClockUs() / 1'000'000, cause);
  if (!path) {
    complain(std::string("the black box could not be copied (") + cause + "): " + path.error().message);
    return;
  }
  complained_ = false;
  blackbox::removeOldCopies(state_dir_, robot_, kCopiesKept);
  log_->info("black box ({}): {}", cause, *path);
}

// Once: a full disk stays full.
void BlackBox::complain(const std::string& why) {
  if (!complained_) log_->warn("{}. Make room there, or set RC10_STATE_DIR to another folder", why);
  complained_ = true;
}

void BlackBox::end() {
  drain();
  (void)file_->end();
}

}  // namespace rc10
