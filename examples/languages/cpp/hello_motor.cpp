// Enables one motor, turns it for a second and prints its state; Ctrl-C lets go of it. C++17, with nothing
// but LCM; robot programs in C++ are shorter with librc10-client (docs/robot-programs.md).
//   hello_motor ROBOT MOTOR RPM
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "rc10/command_t.hpp"
#include "rc10/event_t.hpp"
#include "rc10/named_value_t.hpp"
#include "rc10/request_t.hpp"
#include "rc10/response_t.hpp"
#include "rc10/robot_state_t.hpp"

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t interrupted = 0;

class Program {
 public:
  Program(std::string robot, std::string motor) : robot_(std::move(robot)), motor_(std::move(motor)) {
    std::random_device random;
    session_ = static_cast<std::int64_t>((static_cast<std::uint64_t>(random()) << 31U) ^ random());
    lcm_.subscribe(channel("state"), &Program::onState, this);
    lcm_.subscribe(channel("event"), &Program::onEvent, this);
    lcm_.subscribe(channel("response"), &Program::onResponse, this);
  }

  bool good() { return lcm_.good(); }

  bool enable() { return enabled_ = request("enable"); }

  // Sends a request under one number until it is answered: rc10d carries it out once.
  bool request(const std::string& operation, const std::vector<rc10::named_value_t>& values = {}) {
    rc10::request_t message{};
    message.client = kClient;
    message.session = session_;
    message.seq = awaited_ = ++seq_;
    message.operation = operation;
    message.target = motor_;
    message.value_count = static_cast<std::int32_t>(values.size());
    message.values = values;
    answer_.reset();
    for (int i = 0; i < 50 && !answer_; ++i) {
      lcm_.publish(channel("request"), &message);
      const auto end = Clock::now() + 100ms;
      while (!answer_ && Clock::now() < end) lcm_.handleTimeout(10);
    }
    if (!answer_) std::cerr << "hello_motor: no answer to '" << operation << "': is rc10d running?\n";
    return answer_ && *answer_ == rc10::response_t::STATUS_OK;
  }

  // False once the motor was stopped. Events of a pause of ours may be lost: a state of after it shows what
  // has become of the target.
  bool mayGoOn() {
    const auto resumed = Clock::now();
    while (lcm_.handleTimeout(0) > 0) continue;  // all that waits
    if (commanded_ && resumed > *commanded_ + kPause) {
      const std::int64_t resumed_us =
          std::chrono::duration_cast<std::chrono::microseconds>(resumed.time_since_epoch()).count();
      while (state_us_ < resumed_us && Clock::now() < resumed + kPatience) lcm_.handleTimeout(10);
      const bool lapsed = newest_.owner.empty() && newest_.stop_cause == rc10::motor_state_t::STOP_TIMEOUT;
      if (state_us_ < resumed_us || !(lapsed || newest_.owner == kClient)) stop("in a pause of this program");
    }
    return stopped_.empty();
  }
  // By whom or by what.
  [[nodiscard]] const std::string& stopped() const { return stopped_; }

  void command(std::int8_t mode, double value) {
    rc10::setpoint_t setpoint{};
    setpoint.motor = motor_;
    setpoint.mode = mode;
    setpoint.value = value;
    setpoint.stiffness_nm_per_rad = setpoint.damping_nms_per_rad = NAN;
    rc10::command_t message{};
    message.client = kClient;
    message.session = session_;
    message.seq = ++seq_;
    message.validity_ms = 100;
    message.setpoint_count = 1;
    message.setpoints = {setpoint};
    lcm_.publish(channel("command"), &message);
    commanded_ = Clock::now();
  }

  void receiveFor(Clock::duration time) {
    const auto end = Clock::now() + time;
    while (Clock::now() < end) lcm_.handleTimeout(5);
  }

 private:
  static constexpr const char* kClient = "hello-cpp";
  static constexpr int kMotorStatus = 100;  // code of the events "ACTIVE -> READY (…)"
  static constexpr auto kPause = 100ms;     // between two commands: Ctrl-Z, a busy computer
  static constexpr auto kPatience = 1s;     // for a state of after it

  [[nodiscard]] std::string channel(const std::string& kind) const { return robot_ + ".v1." + kind; }

  void onState(const lcm::ReceiveBuffer*, const std::string&, const rc10::robot_state_t* state) {
    state_us_ = state->mono_us;
    for (const auto& motor : state->motors) {
      if (motor.name != motor_) continue;
      newest_ = motor;
      if (state->mono_us < printed_us_ + 100'000) continue;
      printed_us_ = state->mono_us;
      std::cout << motor.name << " status " << int{motor.status} << " owner '" << motor.owner << "' target "
                << motor.target << " measured " << motor.velocity_rpm << " rpm " << motor.current_a << " A"
                << std::endl;
    }
  }

  // A motor that was stopped, and that somebody enables anew, is not driven on.
  void onEvent(const lcm::ReceiveBuffer*, const std::string&, const rc10::event_t* event) {
    const bool of_motor = event->code == kMotorStatus && event->source == motor_;
    if (enabled_ && of_motor && event->text.rfind("ACTIVE -> ", 0) == 0) stop(event->text);
  }

  void stop(const std::string& why) {
    if (stopped_.empty()) stopped_ = why;
  }

  void onResponse(const lcm::ReceiveBuffer*, const std::string&, const rc10::response_t* response) {
    // All clients hear all answers.
    if (response->session != session_ || response->seq != awaited_) return;
    answer_ = response->status;
    if (*answer_ != rc10::response_t::STATUS_OK) std::cerr << "hello_motor: " << response->message << '\n';
  }

  lcm::LCM lcm_;
  std::string robot_, motor_;
  std::int64_t session_ = 0;  // of this run; a later run has another
  std::int64_t seq_ = 0;      // grows with every message of ours
  std::int64_t awaited_ = 0;
  std::optional<std::int8_t> answer_;
  bool enabled_ = false;  // by us
  std::optional<Clock::time_point> commanded_;
  std::int64_t state_us_ = 0;
  rc10::motor_state_t newest_{};
  std::string stopped_;
  std::int64_t printed_us_ = 0;
};

int main(int count, char** words) {
  if (count != 4) {
    std::cerr << "usage: hello_motor ROBOT MOTOR RPM\n";
    return 2;
  }
  const double rpm = std::strtod(words[3], nullptr);  // before anything is enabled
  Program program(words[1], words[2]);
  if (!program.good()) {
    std::cerr
        << "hello_motor: LCM could not start: sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1\n";
    return 1;
  }
  // Ctrl-C ends the loop below, and the motor is disabled as ever; a second one ends at once.
  const auto interrupt = [](int number) {
    interrupted = 1;
    std::signal(number, SIG_DFL);
  };
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  const bool enabled = program.enable();
  // The loop is what keeps the motor going: a command acts for 100 ms.
  for (int i = 0; enabled && interrupted == 0 && program.mayGoOn() && i < 50; ++i) {
    program.command(rc10::setpoint_t::MODE_VELOCITY, rpm);
    program.receiveFor(20ms);
  }
  bool disabled = false;
  if (program.mayGoOn()) {
    program.command(rc10::setpoint_t::MODE_COAST, 0.0);
    // With our end: what an e-stop holds meanwhile stays held.
    rc10::named_value_t at_end{};
    at_end.name = "at_end";
    at_end.value = 1.0;
    disabled = program.request("disable", {at_end});
  } else {  // and, if it is enabled again, in the hands of another
    std::cerr << "hello_motor: " << words[2] << " was stopped: " << program.stopped() << '\n';
  }
  if (interrupted != 0) return 130;
  return enabled && disabled ? 0 : 1;
}
