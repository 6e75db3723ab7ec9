// A program that commands motors of rc10d as an arm's controller does: a target for each of them, RATE times
// a second, until rc10d ends.
//
//   targets ROBOT RATE impedance|velocity MOTOR...
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "client/link_client.hpp"
#include "client/request_call.hpp"
#include "grid.hpp"
#include "link/run_dir.hpp"
#include "link/words.hpp"

namespace {

[[noreturn]] void die(const std::string& why) {
  std::fprintf(stderr, "targets: %s\n", why.c_str());
  std::exit(1);
}

/// Targets in the middle of what the drives of fake_wire do.
rc10::Target targetOf(rc10::ControlMode mode) {
  rc10::Target target;
  target.mode = mode;
  if (mode == rc10::ControlMode::kImpedance) {
    target.value = 10.0;
    target.stiffness_nm_per_rad = 2.0F;
    target.damping_nms_per_rad = 1.0F;
  } else {
    target.value = 15.0;
  }
  return target;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words{argv + 1, argv + argc};
  if (words.size() < 4) die("usage: targets ROBOT RATE impedance|velocity MOTOR...");
  const std::int64_t rate_hz = std::stoll(words[1]);
  const auto mode = rc10::link::modeOf(words[2]);
  if (!mode || rate_hz < 1) die("no such mode or rate");
  auto client = rc10::LinkClient::connect(rc10::link::socketPath(words[0]), {.name = "targets"});
  if (!client) die(client.error().message);
  rc10::link::Command command;
  command.client = "targets";
  command.session = rc10::randomSession();
  for (std::size_t i = 3; i < words.size(); ++i) {
    auto& setpoint = command.setpoints.at(command.setpoint_count++);
    setpoint.motor = words[i];
    setpoint.target = targetOf(*mode);
  }
  for (std::int64_t due_ns = rc10::peers::now_ns();; rc10::peers::sleepUntil(due_ns)) {
    ++command.seq;
    command.received_ns = 0;
    if (client->send(command) == rc10::LinkClient::SendStatus::kClosed) return 0;
    due_ns += rc10::peers::kSecond_ns / rate_hz;
  }
}
