// The other side of the wire tests: the same messages as liblcm and its lcm-gen for C++ make them.
//
//   wire_peer fingerprints       prints a name and a fingerprint for each type
//   wire_peer recode TYPE        reads a message from stdin, writes what it understood to stdout
//   wire_peer echo FROM TO       over LCM: sends the command_t messages of FROM again on TO
//
#include <lcm/lcm-cpp.hpp>

#include <cstdint>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#define EACH_TYPE(apply)                                                                            \
  apply(bus_state_t) apply(command_t) apply(counter_t) apply(diagnostics_t) apply(durations_t)      \
      apply(event_t) apply(motor_state_t) apply(named_value_t) apply(request_t) apply(response_t)   \
          apply(robot_state_t) apply(service_request_t) apply(service_response_t) apply(setpoint_t) \
              apply(signals_t)

#include "rc10/bus_state_t.hpp"
#include "rc10/command_t.hpp"
#include "rc10/counter_t.hpp"
#include "rc10/diagnostics_t.hpp"
#include "rc10/durations_t.hpp"
#include "rc10/event_t.hpp"
#include "rc10/motor_state_t.hpp"
#include "rc10/named_value_t.hpp"
#include "rc10/request_t.hpp"
#include "rc10/response_t.hpp"
#include "rc10/robot_state_t.hpp"
#include "rc10/service_request_t.hpp"
#include "rc10/service_response_t.hpp"
#include "rc10/setpoint_t.hpp"
#include "rc10/signals_t.hpp"

namespace {

template <typename Message>
int recode(const std::vector<char>& in) {
  Message message;
  if (message.decode(in.data(), 0, static_cast<int>(in.size())) != static_cast<int>(in.size())) {
    return 1;
  }
  std::vector<char> out(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return std::fwrite(out.data(), 1, out.size(), stdout) == out.size() ? 0 : 1;
}

struct Echo {
  lcm::LCM* lcm;
  std::string to;

  void handle(const lcm::ReceiveBuffer*, const std::string&, const rc10::command_t* message) {
    lcm->publish(to, message);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.size() == 1 && args[0] == "fingerprints") {
#define PRINT(type) \
  std::printf("%s %016llx\n", #type, static_cast<unsigned long long>(rc10::type::getHash()));
    EACH_TYPE(PRINT)
    return 0;
  }
  if (args.size() == 2 && args[0] == "recode") {
    const std::vector<char> in{std::istreambuf_iterator<char>(std::cin), {}};
#define RECODE(type)               \
  if (args[1] == #type) {          \
    return recode<rc10::type>(in); \
  }
    EACH_TYPE(RECODE)
  }
  if (args.size() == 3 && args[0] == "echo") {
    lcm::LCM lcm;
    Echo echo{&lcm, args[2]};
    lcm.subscribe(args[1], &Echo::handle, &echo);
    lcm.getFileno();  // from here on it listens
    std::puts("listening");
    std::fflush(stdout);
    while (lcm.handle() == 0) {
    }
  }
  return 2;
}
