// A small robot: waits until the driver arms it, drives a square, aims, and fires three shots.
//
//   WAIT_ARMED -> DRIVE -> AIM -> FIRE -> DONE      and SAFE, from each of them, on any trouble
//
//   small_robot ROBOT [--no-remote]        for example: small_robot small
//
// small_robot.py is the same in Python. The loops that need every millisecond are modules of rc10d
// (robot.yaml); what is here decides 50 times a second what they are told. Nothing that it sends holds for
// long: if this program ends or hangs, the chassis stands and the feeder rests.
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>

#include <rc10/robot.hpp>
#include <rc10/rtos_task.hpp>

using namespace std::chrono_literals;

namespace {

struct Point {
  double x_m;
  double y_m;
};

constexpr std::array<Point, 4> kSquare{{{0.3, 0.0}, {0.3, 0.3}, {0.0, 0.3}, {0.0, 0.0}}};
constexpr double kSpeedMS = 0.8;
constexpr double kGainPerS = 4.0;  // near a corner: m/s for each metre that is left
constexpr double kCloseM = 0.03;

constexpr double kYawDeg = 30.0;
constexpr double kPitchDeg = 10.0;
constexpr double kAimedDeg = 1.0;

constexpr int kShots = 3;
constexpr double kDegPerShot = 45.0;  // as in robot.yaml
constexpr double kNearly = 0.2;       // of a shot: the ball has left by then

constexpr auto kPeriod = 20ms;
constexpr auto kValidity = 200ms;   // some periods: a message may get lost
constexpr auto kForgotten = 500ms;  // idle time after which the feeder has no shot left
constexpr auto kSilence = 500ms;    // older than this nothing is believed
constexpr auto kPatience = 15s;     // time limit of a state of the mission

constexpr const char* kClient = "small-robot";
constexpr std::array kModules{"remote", "base", "gimbal", "feeder"};

class SmallRobot {
 public:
  enum class State { kWaitArmed, kDrive, kAim, kFire, kDone, kSafe };

  SmallRobot(const rc10::Robot& robot, bool has_remote) : robot_(robot), has_remote_(has_remote) {}

  /// One turn of the loop: looks, acts, and says where the robot is now.
  State step() {
    const auto trouble = findTrouble();
    const bool on_mission = state_ == State::kDrive || state_ == State::kAim || state_ == State::kFire;
    if (on_mission && !trouble.empty()) {
      enter(State::kSafe, trouble);
    } else if (on_mission && elapsed() > kPatience) {
      enter(State::kSafe, "it takes too long");
    } else if (const auto next = act(trouble); next != state_) {
      enter(next);
    }
    return state_;
  }

 private:
  /// Does what the state is for. Returns the next state, or the same.
  State act(const std::string& trouble) {
    switch (state_) {
      case State::kWaitArmed: return waitArmed(trouble);
      case State::kDrive: return drive();
      case State::kAim: return aim();
      case State::kFire: return fire();
      case State::kSafe: return safe();
      case State::kDone: break;
    }
    return state_;
  }

  // The driver's switch enables the motors; without a remote, main() has done it.
  static State waitArmed(const std::string& trouble) {
    return trouble.empty() ? State::kDrive : State::kWaitArmed;
  }

  State drive() {
    const double x_m = start_.x_m + kSquare[corner_].x_m - base_.output("x_m");
    const double y_m = start_.y_m + kSquare[corner_].y_m - base_.output("y_m");
    const double left_m = std::hypot(x_m, y_m);
    if (left_m < kCloseM && ++corner_ == kSquare.size()) return State::kAim;
    // At the set speed, and slower near the corner.
    const double per_s = std::fmin(kSpeedMS / left_m, kGainPerS);
    (void)base_.send({{"vx_m_s", per_s * x_m}, {"vy_m_s", per_s * y_m}, {"frame", 1}},  // 1: of the world
                     {.validity = kValidity});
    return State::kDrive;
  }

  State aim() {
    pointGimbal();
    // Shots are counted from here; its first message fires nothing.
    (void)feeder_.send({{"shots", 0}}, {.validity = kValidity});
    const auto gimbal = gimbal_.state();
    const bool aimed = std::fabs(gimbal["yaw_deg"] - kYawDeg) < kAimedDeg &&
                       std::fabs(gimbal["pitch_deg"] - kPitchDeg) < kAimedDeg;
    return aimed && feeder_.state().owner == kClient ? State::kFire : State::kAim;
  }

  State fire() {
    pointGimbal();
    const double turned_deg = robot_.motor("feeder_wheel").state().total_angle_deg - start_deg_;
    const auto now = std::chrono::steady_clock::now();
    if (feeder_.output("shots_left") > 0.0) {
      firing_ = now;
    } else if (now - firing_ > kForgotten) {
      // Our message lapsed once, or somebody else had the feeder: it forgets its shots then, and begins to
      // count anew. One more for each that is missing.
      shots_ += kShots - static_cast<int>(std::floor(turned_deg / kDegPerShot + kNearly));
      firing_ = now;
    }
    (void)feeder_.send({{"shots", shots_}}, {.validity = kValidity});
    return turned_deg > (kShots - kNearly) * kDegPerShot ? State::kDone : State::kFire;
  }

  // Nothing is sent: what was given lapses, and the modules let go. Back again when the driver has seen it,
  // which he shows by the arm switch: down, and then up.
  State safe() const {
    return has_remote_ && remote_.state()["armed"] == 0.0 ? State::kWaitArmed : State::kSafe;
  }

  void pointGimbal() {
    (void)gimbal_.send({{"yaw_deg", kYawDeg}, {"pitch_deg", kPitchDeg}}, {.validity = kValidity});
  }

  /// Reason why the robot must not go on; empty: all is well.
  [[nodiscard]] std::string findTrouble() const {
    const auto state = robot_.state();
    if (!state || state->age() > kSilence) return "no news of rc10d";
    if (state->status != rc10::RobotStatus::kRun)
      return std::string("the robot is in ") + toString(state->status);
    if (has_remote_) {
      const auto remote = remote_.state();
      if (remote.age() > kSilence) return "no news of the remote";
      if (remote["connected"] != 1.0) return "the remote is lost";
      if (remote["armed"] != 1.0) return "the driver has disarmed the robot";
    }
    for (const auto& motor : state->motors) {
      if (motor.status != rc10::MotorStatus::kActive) return motor.name + " is " + toString(motor.status);
    }
    return {};
  }

  void enter(State next, const std::string& why = {}) {
    std::printf("%s -> %s%s%s\n", name(state_), name(next), why.empty() ? "" : ": ", why.c_str());
    std::fflush(stdout);
    state_ = next;
    entered_ = std::chrono::steady_clock::now();
    if (next == State::kDrive) {
      start_ = {base_.output("x_m"), base_.output("y_m")};
      corner_ = 0;
    }
    if (next == State::kFire) {
      start_deg_ = robot_.motor("feeder_wheel").state().total_angle_deg;
      shots_ = kShots;
      firing_ = entered_;
    }
  }

  [[nodiscard]] rc10::Duration elapsed() const { return std::chrono::steady_clock::now() - entered_; }

  static const char* name(State state) {
    constexpr std::array kNames{"WAIT_ARMED", "DRIVE", "AIM", "FIRE", "DONE", "SAFE"};
    return kNames[static_cast<std::size_t>(state)];
  }

  const rc10::Robot& robot_;
  const bool has_remote_;
  const rc10::Module remote_ = robot_.module("remote");
  const rc10::Module base_ = robot_.module("base");
  const rc10::Module gimbal_ = robot_.module("gimbal");
  const rc10::Module feeder_ = robot_.module("feeder");

  State state_ = State::kWaitArmed;
  std::chrono::steady_clock::time_point entered_ = std::chrono::steady_clock::now();
  Point start_{};                                 // of the square, in the world
  std::size_t corner_ = 0;                        // to which it drives
  double start_deg_ = 0.0;                        // of the feeder's wheel
  int shots_ = 0;                                 // asked for so far
  std::chrono::steady_clock::time_point firing_;  // when the feeder last had a shot to fire
};

volatile std::sig_atomic_t interrupted = 0;

int failed(const std::string& why) {
  std::fprintf(stderr, "small_robot: %s\n", why.c_str());
  return 1;
}

int run(const std::string& name, bool has_remote) {
  rc10::RobotOptions options;
  options.client = kClient;
  const rc10::Robot robot(name, options);
  if (const auto heard = robot.waitForState(); !heard) return failed(heard.error().message);
  SmallRobot small_robot(robot, has_remote);
  for (const auto* module : kModules) {
    if (const auto heard = robot.module(module).waitForState(); !heard) return failed(heard.error().message);
  }
  if (!has_remote) {
    if (const auto enabled = robot.enable(); !enabled) return failed(enabled.error().message);
  }
  rc10::Rate rate(kPeriod);
  while (interrupted == 0) {
    const auto state = small_robot.step();
    if (state == SmallRobot::State::kDone) return 0;
    // Without a driver nobody can say that all is well again.
    if (state == SmallRobot::State::kSafe && !has_remote) return 1;
    rate.wait();
  }
  return 0;
  // Leaving the block disables what this program has enabled.
}

}  // namespace

int main(int argc, char** argv) {
  const bool has_remote = argc < 3 || std::string_view(argv[2]) != "--no-remote";
  if (argc < 2 || argc > 3 || (argc == 3 && has_remote)) {
    std::fprintf(stderr, "usage: small_robot ROBOT [--no-remote]\n");
    return 2;
  }
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  return run(argv[1], has_remote);
}
