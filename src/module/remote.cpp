#include "module/remote.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/nearest.hpp"
#include "app/watched_time.hpp"
#include "module/remote_channels.hpp"
#include "module/serial_keys.hpp"
#include "module/steady_channels.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

// Time after the arm switch in which motors are cleared and enabled as they become ready; what fails later,
// or is disabled, stays down until the driver uses the switch again.
constexpr Duration kArming = std::chrono::seconds{3};
// A motor that could not be enabled is tried again.
constexpr Duration kArmingRetry = std::chrono::milliseconds{200};

constexpr std::string_view kChannelPattern = "[a-z0-9_]{1,31}";
constexpr std::array<std::string_view, 2> kRemoteProtocols{"dbus", "sbus"};

constexpr std::array kStickKeys{
    OwnKey{.name = "channel",
           .kind = kText,
           .required = true,
           .about = "The channel: see docs/modules.md for the names.",
           .pattern = kChannelPattern,
           .words = "the name of a channel"},
    OwnKey{.name = "to",
           .kind = kText,
           .required = true,
           .about = "The input of another module.",
           .pattern = kSignalPattern,
           .words = kSignalWords},
    OwnKey{.name = "scale",
           .kind = kNumber,
           .min = -1e6,
           .max = 1e6,
           .default_text = "1",
           .about = "Value of the input at full deflection."},
    OwnKey{.name = "deadband",
           .kind = kNumber,
           .max = 0.9,
           .default_text = "0.05",
           .about = "A smaller deflection is 0; beyond it the value begins at 0."}};

constexpr std::array kConstantKeys{OwnKey{.name = "to",
                                          .kind = kText,
                                          .required = true,
                                          .about = "The input of another module.",
                                          .pattern = kSignalPattern,
                                          .words = kSignalWords},
                                   OwnKey{.name = "value",
                                          .kind = kNumber,
                                          .min = -1e6,
                                          .max = 1e6,
                                          .required = true,
                                          .about = "Its value while the remote commands."}};

constexpr std::array kRemoteKeys{
    kPortKey,
    OwnKey{.name = "protocol",
           .kind = kChoice,
           .choices = kRemoteProtocols,
           .required = true,
           .about =
               "Protocol of the receiver: dbus (DJI DR16, 100000 8E1) or sbus (100000 8E2). Both need an "
               "inverter before an ordinary UART."},
    OwnKey{.name = "lost_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 20,
           .max = 5000,
           .default_text = "100",
           .about = "Without a frame for this time, or as soon as the receiver says so, the remote is lost: "
                    "it commands nothing."},
    OwnKey{.name = "disable_s",
           .kind = kNumber,
           .unit = "s",
           .max = 3600,
           .default_text = "1",
           .about = "Time after a loss at which every motor is disabled."},
    OwnKey{.name = "arm_channel",
           .kind = kText,
           .about = "The switch that enables the robot when it goes up, and disables it when it goes "
                    "down. Default: none; it commands whenever it is heard.",
           .pattern = kChannelPattern,
           .words = "the name of a channel"},
    OwnKey{.name = "arm_above",
           .kind = kNumber,
           .min = -1,
           .max = 1,
           .default_text = "0.5",
           .about = "Above this the switch is up."},
    OwnKey{.name = "sticks",
           .kind = kRows,
           .max = 30,
           .about = "What the channels command.",
           .keys = kStickKeys},
    OwnKey{.name = "constants",
           .kind = kRows,
           .max = 30,
           .about = "What it gives beside its channels while it commands.",
           .keys = kConstantKeys}};

ModuleSignals remoteSignals(const RemoteChannels& channels) {
  ModuleSignals signals;
  signals.outputs = {"connected", "armed", "age_ms"};
  signals.outputs.insert(signals.outputs.end(), channels.names().begin(), channels.names().end());
  signals.events = {{.text = "the remote is lost: it commands nothing"},
                    {.text = "the remote is back", .expected = true},
                    {.text = "the remote has been lost for too long: every motor is disabled"},
                    {.text = "the arm switch went up: motors are enabled", .expected = true}};
  return signals;
}

/// Route of one channel to one input.
struct Stick {
  std::size_t channel = 0;
  std::string to;
  double scale = 1.0;
  double deadband = 0.0;
  SignalPlace place{};

  [[nodiscard]] double value(double deflection) const noexcept {
    const double beyond = std::max(0.0, std::fabs(deflection) - deadband) / (1.0 - deadband);
    return std::copysign(beyond, deflection) * scale;
  }
};

struct Constant {
  std::string to;
  double value = 0.0;
  SignalPlace place{};
};

[[nodiscard]] std::vector<double> tolerancesOf(const RemoteChannels& channels) {
  std::vector<double> tolerances(channels.names().size());
  for (std::size_t i = 0; i < tolerances.size(); ++i) tolerances[i] = channels.tolerance(i);
  return tolerances;
}

class Remote : public Module_Base {
 public:
  Remote(const OwnValues& own, std::unique_ptr<RemoteChannels> channels, std::vector<Stick> sticks,
         std::optional<std::size_t> arm_channel, std::size_t motor_count)
      : Module_Base(remoteSignals(*channels)),
        path_(own.text("port")),
        lost_(std::chrono::milliseconds{own.integer("lost_ms")}),
        disable_s_(own.number("disable_s")),
        arm_channel_(arm_channel),
        arm_above_(own.number("arm_above")),
        sticks_(std::move(sticks)),
        channels_(std::move(channels)),
        newest_(channels_->names().size(), kNoSignal),
        steady_(tolerancesOf(*channels_)),
        was_active_(motor_count, false),
        some_(motor_count) {
    for (const auto& row : own.rows("constants"))
      constants_.push_back({row.text("to"), row.number("value"), {}});
  }

  [[nodiscard]] std::optional<SerialNeed> takeSerialNeed() override {
    return SerialNeed{.path = path_, .format = channels_->format(), .protocol = channels_->takeProtocol()};
  }

  [[nodiscard]] Result<void> connect(const ModuleDirectory& others) override {
    for (auto& stick : sticks_) {
      auto place = others.findInput(stick.to);
      if (!place) return fail("sticks: " + place.error().message);
      stick.place = *place;
    }
    for (auto& constant : constants_) {
      auto place = others.findInput(constant.to);
      if (!place) return fail("constants: " + place.error().message);
      constant.place = *place;
    }
    return {};
  }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const Duration age = channels_->age(tick.now);
    const bool lost = channels_->saysLost();
    if (age < lost_) takeFrame(tick.now - age, lost);
    const bool heard = age < lost_ && !lost && steady_.heard();
    watchLink(heard, tick, robot);
    if (heard) {
      robot.hearClient(tick.now - age);
      watchArm(tick, robot);
    }
    // An e-stop or a disable ends what the switch has asked for; the end of an e-stop enables nothing.
    const bool disabled = std::exchange(disables_, robot.disables()) != robot.disables();
    if (disabled || robot.state() != RobotStatus::kRun) arming_until_ = tick.now;
    // After a gap the switch counts from the second frame. It may be going down: it counts as up until two
    // frames say so, and acts no more from the first on. It clears and enables when both show it up.
    const bool up = heard && armed_ && switch_up_.value_or(false) && last_up_.value_or(false);
    if (up && switch_agrees_) arm(tick, robot);
    if (up || (heard && !arm_channel_)) command(robot);
    show(heard, age);
  }

 private:
  enum Output : std::size_t { kConnected, kArmed, kAgeMs, kFirstChannel };
  enum EventPlace : std::size_t { kLost, kBack, kDisabled, kEnables };

  void watchLink(bool heard, const Tick& tick, ModuleRobot& robot) noexcept {
    if (heard) {
      if (was_heard_ == 0) robot.report(kBack);
      was_heard_ = 1;
      lost_time_.restart();
      told_to_disable_ = false;
      return;
    }
    // A remote that was never heard is not lost.
    if (was_heard_ < 0) return;
    if (was_heard_ == 1) robot.report(kLost);
    was_heard_ = 0;
    lost_time_.step(tick);
    if (told_to_disable_ || lost_time_.seconds() < disable_s_) return;
    told_to_disable_ = true;
    armed_ = false;
    // It must go down and up once more.
    switch_known_ = false;
    last_up_ = switch_up_ = std::nullopt;
    robot.askAll(RobotRequest::kDisableUnasked);
    robot.report(kDisabled);
  }

  // A motor that is not on may be held by an e-stop or for its group: it stays so until it is enabled again.
  void disableWhatIsOn(ModuleRobot& robot) noexcept {
    std::size_t on = 0;
    for (std::size_t motor = 0; motor < was_active_.size(); ++motor) {
      const auto status = robot.status(motor);
      if (status == MotorStatus::kActive || status == MotorStatus::kEnabling) some_[on++] = motor;
    }
    if (on > 0) robot.ask(RobotRequest::kDisable, std::span{some_}.first(on));
    robot.askAll(RobotRequest::kDisableUnasked);
  }

  // Neither protocol has a checksum, and parity lets two wrong bits pass. After a gap all is read anew. One
  // frame that the receiver lost is none, two are.
  void takeFrame(MonotonicTime received, bool lost) noexcept {
    if (received == last_frame_) return;
    const bool again = std::exchange(lost_frame_, lost) && lost;
    if (again || received - last_good_ >= lost_) {
      steady_.restart();
      last_up_ = switch_up_ = std::nullopt;
      switch_agrees_ = false;
    }
    last_frame_ = received;
    if (lost) return;
    last_good_ = received;
    channels_->read(newest_);
    steady_.take(newest_);
    if (arm_channel_) takeSwitch(newest_[*arm_channel_]);
  }

  // Two frames in a row are right; the first that shows it down is seen as well.
  void takeSwitch(double value) noexcept {
    const bool up = value > arm_above_;
    switch_agrees_ = last_up_ == up;
    if (switch_agrees_) {
      switch_up_ = up;
      switch_ = value;
    }
    last_up_ = up;
  }

  // Only a switch that was seen down can go up: one that is up when the robot starts enables nothing.
  void watchArm(const Tick& tick, ModuleRobot& robot) noexcept {
    if (!switch_up_) return;
    if (!*switch_up_) {
      // Motors that others enabled, too. A switch that is down after a gap went down within it.
      if (std::exchange(seen_up_, false)) disableWhatIsOn(robot);
      armed_ = false;
      switch_known_ = true;
      return;
    }
    seen_up_ = true;
    if (switch_known_ && !armed_) {
      armed_ = true;
      arming_until_ = tick.now + kArming;
      std::fill(was_active_.begin(), was_active_.end(), false);
      next_try_ = tick.now;
      robot.report(kEnables);
    }
  }

  // Clears faults and enables, for a while: after a power cut drives come back one after the other. An e-stop
  // stays: clearing it is another decision.
  void arm(const Tick& tick, ModuleRobot& robot) noexcept {
    if (tick.now >= arming_until_) return;
    for (std::size_t motor = 0; motor < was_active_.size(); ++motor)
      was_active_[motor] = was_active_[motor] || robot.status(motor) == MotorStatus::kActive;
    if (tick.now < next_try_) return;
    next_try_ = tick.now + kArmingRetry;
    std::size_t ready = 0;
    for (std::size_t motor = 0; motor < was_active_.size(); ++motor) {
      if (was_active_[motor]) continue;
      if (robot.status(motor) == MotorStatus::kFault) robot.ask(RobotRequest::kClear, motor);
      if (robot.status(motor) == MotorStatus::kReady) some_[ready++] = motor;
    }
    // At once: some are enabled together or not at all.
    if (ready > 0) robot.ask(RobotRequest::kEnable, std::span{some_}.first(ready));
  }

  // All or nothing: an input that is missing for a frame would fall and rise again.
  void command(ModuleRobot& robot) const noexcept {
    if (!steady_.settled()) return;
    for (const auto& stick : sticks_) robot.send(stick.place, stick.value(steady_[stick.channel]));
    for (const auto& constant : constants_) robot.send(constant.place, constant.value);
  }

  void show(bool heard, Duration age) noexcept {
    setOutput(kConnected, heard ? 1.0 : 0.0);
    setOutput(kArmed, armed_ ? 1.0 : 0.0);
    setAge(kAgeMs, age);
    for (std::size_t i = 0; i < newest_.size(); ++i)
      setOutput(kFirstChannel + i, heard ? steady_[i] : kNoSignal);
    // A switch shown down counts as down: moving it up then arms.
    if (arm_channel_ && heard) setOutput(kFirstChannel + *arm_channel_, switch_up_ ? switch_ : kNoSignal);
  }

  std::string path_;
  Duration lost_;
  double disable_s_;
  std::optional<std::size_t> arm_channel_;
  double arm_above_;
  std::vector<Stick> sticks_;
  std::vector<Constant> constants_;
  std::unique_ptr<RemoteChannels> channels_;
  std::vector<double> newest_;     ///< As the last frame has them.
  SteadyChannels steady_;          ///< As they are believed.
  std::vector<bool> was_active_;   ///< Motors that were ACTIVE since the switch went up.
  std::vector<std::size_t> some_;  ///< Room for the motors of one request.

  std::optional<bool> last_up_;    ///< The switch in the last frame.
  std::optional<bool> switch_up_;  ///< The switch as two frames in a row had it.
  bool switch_agrees_ = false;     ///< The last two frames agree on it.
  double switch_ = kNoSignal;      ///< Its channel when they had it.
  MonotonicTime last_frame_{};     ///< When it came,
  MonotonicTime last_good_{};      ///< and the last that the receiver had heard.
  bool lost_frame_ = false;        ///< The receiver had lost the last one.

  int was_heard_ = -1;  ///< -1: never.
  bool armed_ = false;
  bool switch_known_ = false;  ///< It was seen down since the remote was heard again.
  bool seen_up_ = false;       ///< It was up when it was last seen, before a gap too.
  bool told_to_disable_ = false;
  WatchedTime lost_time_;
  MonotonicTime arming_until_{};
  MonotonicTime next_try_{};
  std::uint32_t disables_ = 0;  ///< ModuleRobot::disables() of the tick before.
};

Result<std::size_t> findChannel(const RemoteChannels& channels, const std::string& name, const char* key) {
  const auto& names = channels.names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::string known;
  for (const auto& word : names) known += (known.empty() ? "" : ", ") + word;
  return fail(std::string{key} + ": there is no channel '" + name + "'; there are " + known +
              didYouMean(name, {names.begin(), names.end()}));
}

class RemoteType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "remote"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "The driver's remote control: commands other modules and enables the robot.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return kRemoteKeys; }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto& own = settings.own;
    auto channels = RemoteChannels::make(own.text("protocol"));
    std::optional<std::size_t> arm_channel;
    if (own.given("arm_channel")) {
      const auto channel = findChannel(*channels, own.text("arm_channel"), "arm_channel");
      if (!channel) return tl::unexpected(channel.error());
      arm_channel = *channel;
    }
    std::vector<Stick> sticks;
    for (const auto& row : own.rows("sticks")) {
      const auto channel = findChannel(*channels, row.text("channel"), "sticks");
      if (!channel) return tl::unexpected(channel.error());
      sticks.push_back({*channel, row.text("to"), row.number("scale"), row.number("deadband"), {}});
    }
    return std::make_unique<Remote>(own, std::move(channels), std::move(sticks), arm_channel,
                                    robot.motors.size());
  }
};

}  // namespace

const ModuleType& remoteType() noexcept {
  static const RemoteType kType;
  return kType;
}

}  // namespace rc10
