#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "rc10/command_t.hpp"
#include "rc10/event_t.hpp"
#include "rc10/lcm_link.hpp"
#include "rc10/request_t.hpp"
#include "rc10/response_t.hpp"
#include "rc10/robot_state_t.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test {

/// Bound of a test's wait for what has to happen. Nothing waits this long when all is well.
inline constexpr auto kPatience = std::chrono::seconds{20};

/// rc10d as a client sees it, on the client's own memq link: it answers requests, takes commands, and
/// publishes a state when it is told to. Its clock, and so what it stamps, is a test's.
class FakeRc10d {
 public:
  explicit FakeRc10d(const LcmLink& link, std::string robot = "hero")
      : link_(link),
        robot_(std::move(robot)),
        commands_(link.subscribe(channel("command"), [this](auto bytes) { onCommand(bytes); })),
        requests_(link.subscribe(channel("request"), [this](auto bytes) { onRequest(bytes); })) {
    for (const auto* name : {"lift", "wheel", "yaw"}) motors[name] = motor(name);
  }

  // Settings of a test, before the state or the answer goes out; under `mutex` once a client runs.
  std::mutex mutex;
  std::map<std::string, motor_state_t> motors;
  std::int8_t robot_state = robot_state_t::STATE_RUN;
  std::map<std::string, std::pair<std::int8_t, std::string>> verdicts;  ///< By operation; OK without one.
  int deaf_to_requests = 0;
  bool shows_estop = true;
  bool shows_enabled = true;  ///< Else no state follows an answer, and the next ones are from before it.
  bool obeys = true;

  /// Publishes a state, `after` the one before by its clock.
  void publishState(std::chrono::milliseconds after = std::chrono::milliseconds{5}) {
    robot_state_t state;
    {
      const std::lock_guard lock(mutex);
      now_us_ += std::chrono::duration_cast<std::chrono::microseconds>(after).count();
      state.utime = 1;
      state.mono_us = now_us_;
      state.tick = now_us_ / 1000;
      state.state = robot_state;
      state.realtime = 1;
      for (const auto& [name, motor] : motors) state.motors.push_back(motor);
      state.motor_count = static_cast<std::int32_t>(state.motors.size());
    }
    EXPECT_TRUE(link_.publish(channel("state"), state));
  }

  void publishEvent(std::int32_t code, const std::string& source, const std::string& text) {
    event_t event{};
    event.code = code;
    event.source = source;
    event.text = text;
    EXPECT_TRUE(link_.publish(channel("event"), event));
  }

  /// Waits until a command fulfils `wanted`, the ones before included; false: none came.
  template <typename Wanted>
  bool awaitCommand(Wanted wanted) {
    return await([&] { return std::any_of(received.begin(), received.end(), wanted); });
  }
  bool awaitCommands(std::size_t count) {
    return await([&] { return received.size() >= count; });
  }
  bool awaitRequests(std::size_t count) {
    return await([&] { return asked.size() >= count; });
  }

  [[nodiscard]] std::vector<command_t> commands() {
    const std::lock_guard lock(mutex);
    return received;
  }
  [[nodiscard]] std::vector<request_t> requests() {
    const std::lock_guard lock(mutex);
    return asked;
  }
  /// "enable lift,yaw"; a repeated request counts once.
  [[nodiscard]] std::vector<std::string> operations() {
    const std::lock_guard lock(mutex);
    return executed;
  }

  [[nodiscard]] std::string channel(const char* kind) const { return robot_ + ".v1." + kind; }

  std::vector<command_t> received;
  std::vector<request_t> asked;
  std::vector<std::string> executed;

 private:
  /// A client that this computer has held up sends nothing before it has heard a state of after that.
  template <typename Reached>
  bool await(Reached reached) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    std::unique_lock lock(mutex);
    while (!changed_.wait_for(lock, std::chrono::milliseconds{200}, reached)) {
      if (std::chrono::steady_clock::now() >= end) return false;
      lock.unlock();
      publishState(std::chrono::seconds{1});
      lock.lock();
    }
    return true;
  }

  static motor_state_t motor(const char* name) {
    motor_state_t motor{};
    motor.name = name;
    motor.status = motor_state_t::STATUS_READY;
    motor.zeroed = 1;
    motor.velocity_rpm = 12.5F;
    motor.voltage_v = std::numeric_limits<float>::quiet_NaN();
    return motor;
  }

  void onCommand(std::span<const std::byte> bytes) {
    command_t command;
    ASSERT_TRUE(LcmLink::decode(bytes, command));
    {
      const std::lock_guard lock(mutex);
      for (const auto& setpoint : command.setpoints) {
        const auto found = motors.find(setpoint.motor);
        if (!obeys || found == motors.end()) continue;
        found->second.mode = setpoint.mode;
        found->second.target = setpoint.value;
        found->second.owner = command.client;
      }
      received.push_back(command);
    }
    changed_.notify_all();
  }

  void onRequest(std::span<const std::byte> bytes) {
    request_t request;
    ASSERT_TRUE(LcmLink::decode(bytes, request));
    response_t response{};
    bool twice_a_state = false;
    {
      const std::lock_guard lock(mutex);
      asked.push_back(request);
      changed_.notify_all();
      if (deaf_to_requests > 0) {
        --deaf_to_requests;
        return;
      }
      const auto verdict = verdicts.find(request.operation);
      response.client = request.client;
      response.session = request.session;
      response.seq = request.seq;
      if (verdict != verdicts.end()) {
        response.status = verdict->second.first;
        response.message = verdict->second.second;
      }
      if (known_.insert({request.session, request.seq}).second) execute(request, response.status);
      twice_a_state = (request.operation == "enable" && shows_enabled) || request.operation == "estop";
    }
    EXPECT_TRUE(link_.publish(channel("response"), response));
    if (twice_a_state) {
      publishState();
      publishState();
    }
  }

  void execute(const request_t& request, std::int8_t status) {
    executed.push_back(request.target.empty() ? request.operation : request.operation + " " + request.target);
    if (status != response_t::STATUS_OK) return;
    if (request.operation == "estop" && shows_estop) robot_state = robot_state_t::STATE_ESTOP;
    for (auto& [name, motor] : motors) {
      const bool meant = request.target.empty() || request.target.find(name) != std::string::npos;
      if (!meant) continue;
      if (request.operation == "enable" && shows_enabled) motor.status = motor_state_t::STATUS_ACTIVE;
      if (request.operation == "disable") motor.status = motor_state_t::STATUS_READY;
    }
  }

  LcmLink link_;
  std::string robot_;
  std::condition_variable changed_;
  std::int64_t now_us_ = 1'000'000'000;
  std::set<std::pair<std::int64_t, std::int64_t>> known_;
  // Last: they end first.
  Subscription commands_;
  Subscription requests_;
};

}  // namespace test
}  // namespace robot_client
}  // namespace rc10
