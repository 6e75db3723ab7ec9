// One side of bench/path_latency: sends commands and inputs of a module, each with a number of its own, and
// says when; then says how old states are when they come. Times are CLOCK_MONOTONIC.
//   path_latency_client link|lcm ROBOT COUNT
#include <poll.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "client/link_client.hpp"
#include "client/request_call.hpp"
#include "link/run_dir.hpp"
#include "rc10/robot.hpp"

namespace {

using namespace std::chrono_literals;

[[noreturn]] void die(const std::string& why) {
  std::fprintf(stderr, "path_latency_client: %s\n", why.c_str());
  std::exit(1);
}

[[nodiscard]] double nowUs() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Sends at times that have nothing to do with the tick, and prints each.
void send(const char* what, int count, const std::function<void(double number)>& once) {
  std::minstd_rand random{1};
  std::uniform_real_distribution<double> wait_ms{4.0, 8.0};
  for (int i = 0; i < count; ++i) {
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(wait_ms(random)));
    const double number = i;
    const double sent_us = nowUs();
    once(number);
    std::printf("%s %d %.1f\n", what, i, sent_us);
  }
}

// Numbers that the robot survives: the wheel is pushed to and fro, the feeder turns slowly.
[[nodiscard]] double currentA(double number) {
  return (std::fmod(number, 2.0) == 0.0 ? 1.0 : -1.0) * (0.1 + 0.0005 * number);
}
[[nodiscard]] double velocityRpm(double number) { return 20.0 + 0.01 * number; }

[[nodiscard]] rc10::LinkClient connect(const std::string& robot, std::uint32_t subscriptions) {
  auto client = rc10::LinkClient::connect(
      rc10::link::socketPath(robot), {.name = "bench-link", .subscriptions = subscriptions, .timeout = 5s});
  if (!client) die(client.error().message);
  return std::move(*client);
}

void throughLink(const std::string& robot, int count) {
  auto client = connect(robot, 0);
  const auto session = rc10::randomSession();
  std::int64_t seq = 0;
  send("command", count, [&](double number) {
    rc10::link::Command command;
    command.client = "bench-link";
    command.session = session;
    command.seq = ++seq;
    command.setpoint_count = 1;
    command.setpoints[0].motor = "wheel";
    command.setpoints[0].target.mode = rc10::ControlMode::kCurrent;
    command.setpoints[0].target.value = currentA(number);
    if (client.send(command) != rc10::LinkClient::SendStatus::kSent) die("rc10d does not read");
  });
  send("module", count, [&](double number) {
    rc10::link::Signals signals;
    signals.client = "bench-link";
    signals.session = session;
    signals.seq = ++seq;
    signals.module = "feeder";
    signals.value_count = 1;
    signals.values[0].name = "velocity_rpm";
    signals.values[0].value = velocityRpm(number);
    if (client.send(signals) != rc10::LinkClient::SendStatus::kSent) die("rc10d does not read");
  });
  std::vector<std::byte> buffer(rc10::link::kMaxMessageSize);
  auto listener = connect(robot, rc10::link::kStates);
  for (int i = 0; i < count;) {
    pollfd readable{listener.descriptor(), POLLIN, 0};
    if (::poll(&readable, 1, 5000) <= 0) die("no states");
    const auto received = listener.receive(buffer);
    const double now_us = nowUs();
    rc10::link::State state;
    if (received.status != rc10::LinkClient::ReceiveStatus::kMessage) continue;
    if (!rc10::link::open(received.datagram, state)) continue;
    std::printf("state %d %.1f\n", i++, now_us - static_cast<double>(state.mono_us));
  }
}

void throughLcm(const std::string& name, int count) {
  rc10::RobotOptions options;
  options.client = "bench-cpp";
  options.validity = 50ms;
  options.resend = 0ms;  // each is sent once
  const rc10::Robot robot(name, options);
  if (const auto heard = robot.waitForState(); !heard) die(heard.error().message);
  const auto wheel = robot.motor("wheel");
  const auto feeder = robot.module("feeder");
  send("command", count, [&](double number) {
    if (const auto sent = wheel.setTargetCurrent(rc10::Amperes{currentA(number)}); !sent)
      die(sent.error().message);
  });
  send("module", count, [&](double number) {
    if (const auto sent = feeder.send({{"velocity_rpm", velocityRpm(number)}}); !sent)
      die(sent.error().message);
  });
  std::mutex mutex;
  std::condition_variable enough;
  std::vector<double> ages_us;
  robot.onState([&](const rc10::RobotState& state) {
    const double age_us = nowUs() - static_cast<double>(state.mono_us);
    const std::lock_guard lock(mutex);
    ages_us.push_back(age_us);
    enough.notify_one();
  });
  {
    std::unique_lock lock(mutex);
    enough.wait(lock, [&] { return ages_us.size() >= static_cast<std::size_t>(count); });
  }
  robot.onState(nullptr);
  const std::lock_guard lock(mutex);
  for (int i = 0; i < count; ++i) std::printf("state %d %.1f\n", i, ages_us[static_cast<std::size_t>(i)]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) die("usage: path_latency_client link|lcm ROBOT COUNT");
  const int count = std::atoi(argv[3]);
  std::string(argv[1]) == "link" ? throughLink(argv[2], count) : throughLcm(argv[2], count);
}
