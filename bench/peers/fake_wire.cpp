// Drives of a robot as a wire would carry them, and what they leave of the computer. In a guest whose clock
// counts instructions, see guest.py:
//
//   fake_wire damiao|dji COUNT SECONDS [--hog-us N] [PID]
//
// COUNT drives on vcan0 (dji: on vcan1 too) send a frame each per millisecond, 110 us apart, from 150 us
// after the whole millisecond: an eight-byte frame at 1 Mbit/s. They are enabled, and until the measurement
// begins they hear: Damiao drives let themselves be disabled, asked and enabled. --hog-us: a FIFO-50 thread
// is busy for so long every 10 ms. Prints one JSON object: thousands of instructions per millisecond of the
// whole computer, and of the threads of process PID, and how often these were switched to a millisecond.
#include <dirent.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "grid.hpp"

namespace {

using rc10::peers::now_ns;
using rc10::peers::schedule;
using rc10::peers::sleepUntil;

constexpr std::int64_t kMs = rc10::peers::kMs_ns;
constexpr std::int64_t kFirstFrame = 150'000;
constexpr std::int64_t kSpacing = 110'000;
constexpr std::int64_t kHogPeriod = 10 * kMs;
// Programs of the script start, and rc10d enables its motors.
constexpr std::int64_t kSettling = 3000 * kMs;
constexpr std::int64_t kHearing = kSettling - 500 * kMs;
constexpr int kDrivesPriority = 70;
constexpr int kHogPriority = 50;

std::atomic<bool> ended{false};

[[noreturn]] void fail(const char* what) {
  std::perror(what);
  std::_Exit(1);
}

// Receives frames with these ids; without any it never reads, and so it must not receive.
int openBus(const char* name, const std::vector<can_filter>& heard = {}) {
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(name));
  if (fd < 0 || address.can_ifindex == 0 ||
      ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, heard.data(),
                   static_cast<socklen_t>(heard.size() * sizeof(can_filter))) != 0 ||
      ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail(name);
  return fd;
}

struct Options {
  bool dji = false;
  unsigned count = 0;
  int seconds = 0;
  std::int64_t hog_ns = 0;
  std::string pid;
};

// Both turn, as their speed says: a rotor by 40 of 8192 steps each millisecond, a joint forth and back.
constexpr unsigned kRotorSteps = 40;
constexpr int kRotorRpm = 293;
constexpr unsigned kJointSteps = 10;  // of 25 rad / 65535
constexpr int kJointSpeed = 260;      // of 60 rad/s / 4095
constexpr unsigned kJointTurns = 50;

can_frame rotor(unsigned drive, unsigned turn) {  // C620: rotor angle, speed, current, temperature
  can_frame frame{};
  frame.can_id = 0x201 + drive;
  frame.can_dlc = 8;
  const unsigned angle = turn * kRotorSteps % 8192;
  frame.data[0] = static_cast<__u8>(angle >> 8U);
  frame.data[1] = static_cast<__u8>(angle);
  frame.data[2] = kRotorRpm >> 8;
  frame.data[3] = kRotorRpm & 0xFF;
  frame.data[6] = 30;
  return frame;
}

/// A DM4310 with id 1 to 15 that answers at 16 above it.
class Joint {
 public:
  explicit Joint(unsigned id) : id_(id) {}
  [[nodiscard]] can_filter commands() const { return {.can_id = id_, .can_mask = CAN_SFF_MASK}; }

  // Id and state (1: enabled), position, velocity and torque around their middles.
  [[nodiscard]] can_frame feedback(unsigned turn) const {
    can_frame frame = from(0x10U + id_);
    const unsigned phase = turn % (2 * kJointTurns);
    const bool back = phase >= kJointTurns;
    const unsigned position = 32768 + kJointSteps * (back ? 2 * kJointTurns - phase : phase);
    const unsigned velocity = static_cast<unsigned>(2048 + (back ? -kJointSpeed : kJointSpeed));
    frame.data[0] = static_cast<__u8>(id_ | (enabled_ ? 0x10U : 0U));
    frame.data[1] = static_cast<__u8>(position >> 8U);
    frame.data[2] = static_cast<__u8>(position);
    frame.data[3] = static_cast<__u8>(velocity >> 4U);
    frame.data[4] = static_cast<__u8>((velocity & 0xFU) << 4U | 0x8U);
    frame.data[6] = frame.data[7] = 30;
    return frame;
  }
  /// True: `answer` is what it says.
  bool hear(const can_frame& frame, can_frame& answer) {
    if (frame.can_id == id_) {
      const bool special = std::memcmp(frame.data, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 7) == 0;
      if (special && frame.data[7] == 0xFC) enabled_ = true;
      if (special && frame.data[7] == 0xFD) enabled_ = false;
      return false;  // its next feedback says it
    }
    if (frame.data[0] != id_) return false;
    answer = from(0x10U + id_);
    std::memcpy(answer.data, frame.data, sizeof answer.data);
    std::uint32_t& value = registers_[frame.data[3]];
    if (frame.data[2] == 0x55)
      std::memcpy(&value, frame.data + 4, sizeof value);
    else
      std::memcpy(answer.data + 4, &value, sizeof value);
    return true;
  }

 private:
  static can_frame from(unsigned id) {
    can_frame frame{};
    frame.can_id = id;
    frame.can_dlc = 8;
    return frame;
  }

  unsigned id_;
  bool enabled_ = true;
  // PMAX, VMAX and TMAX of the model; others are what was written.
  std::map<std::uint8_t, std::uint32_t> registers_{{21, std::bit_cast<std::uint32_t>(12.5F)},
                                                   {22, std::bit_cast<std::uint32_t>(30.0F)},
                                                   {23, std::bit_cast<std::uint32_t>(10.0F)}};
};

void turnRotors(const Options& options) {
  schedule(SCHED_FIFO, kDrivesPriority);
  const std::array buses{openBus("vcan0"), openBus("vcan1")};
  std::int64_t start = (now_ns() / kMs + 3) * kMs + kFirstFrame;
  for (unsigned turn = 0; !ended; ++turn, start += kMs) {
    for (unsigned i = 0; i < options.count; ++i) {
      sleepUntil(start + i * kSpacing);
      const can_frame frame = rotor(i, turn);
      for (const int bus : buses) (void)!::write(bus, &frame, sizeof frame);
    }
  }
}

void answerAll(int ears, int bus, std::vector<Joint>& joints) {
  can_frame heard{};
  can_frame answer{};
  while (::recv(ears, &heard, sizeof heard, MSG_DONTWAIT) > 0) {
    for (Joint& joint : joints)
      if (joint.hear(heard, answer)) (void)!::write(bus, &answer, sizeof answer);
  }
}

void moveJoints(const Options& options) {
  schedule(SCHED_FIFO, kDrivesPriority);
  std::vector<Joint> joints;
  std::vector<can_filter> heard{{.can_id = 0x7FF, .can_mask = CAN_SFF_MASK}};
  for (unsigned id = 1; id <= options.count; ++id) heard.push_back(joints.emplace_back(id).commands());
  const int bus = openBus("vcan0");
  int ears = openBus("vcan0", heard);
  const std::int64_t deaf = now_ns() + kHearing;
  std::int64_t start = (now_ns() / kMs + 3) * kMs + kFirstFrame;
  for (unsigned turn = 0; !ended; ++turn, start += kMs) {
    for (unsigned i = 0; i < options.count; ++i) {
      sleepUntil(start + i * kSpacing);
      const can_frame frame = joints[i].feedback(turn);
      (void)!::write(bus, &frame, sizeof frame);
    }
    if (ears < 0) continue;
    answerAll(ears, bus, joints);
    if (start > deaf) {
      ::close(ears);
      ears = -1;
    }
  }
}

void hog(std::int64_t busy_ns) {
  schedule(SCHED_FIFO, kHogPriority);
  for (std::int64_t start = (now_ns() / kHogPeriod + 1) * kHogPeriod - busy_ns / 2; !ended;
       start += kHogPeriod) {
    sleepUntil(start);
    while (now_ns() < start + busy_ns) {
    }
  }
}

[[gnu::noinline]] void work() {
  volatile unsigned turns = 0;
  while (turns < 1000) turns = turns + 1;
}

// Time of work() where nothing interrupts it: the least of many.
double workNs() {
  constexpr int kTries = 1000;
  std::int64_t least = kMs;
  std::int64_t nothing = kMs;
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t start = now_ns();
    work();
    const std::int64_t between = now_ns();
    const std::int64_t end = now_ns();
    least = std::min(least, between - start);
    nothing = std::min(nothing, end - between);
  }
  return static_cast<double>(least - nothing);
}

// Takes what nobody else wants. Returns how much that was, by the work done: these kernels charge interrupts
// to the thread that they interrupt (no CONFIG_IRQ_TIME_ACCOUNTING), so its CPU time has them.
double spin() {
  schedule(SCHED_IDLE, 0);
  const double work_ns = workNs();
  std::int64_t done = 0;
  for (; !ended; ++done) work();
  return static_cast<double>(done) * work_ns;
}

struct Use {
  std::int64_t cpu_ns = 0;
  std::int64_t switches = 0;
};

// Use of the CPU by the threads of a process, by name: the first and third field of schedstat.
std::map<std::string, Use> threads(const std::string& pid) {
  std::map<std::string, Use> used;
  const std::string folder = "/proc/" + pid + "/task";
  DIR* const tasks = pid.empty() ? nullptr : ::opendir(folder.c_str());
  if (tasks == nullptr) return used;
  while (const dirent* task = ::readdir(tasks)) {
    if (task->d_name[0] == '.') continue;  // ".." has the figures of the main thread once more
    std::string name;
    Use use;
    std::int64_t waited = 0;
    std::getline(std::ifstream(folder + '/' + task->d_name + "/comm"), name);
    std::ifstream(folder + '/' + task->d_name + "/schedstat") >> use.cpu_ns >> waited >> use.switches;
    if (name.empty()) continue;
    used[name].cpu_ns += use.cpu_ns;
    used[name].switches += use.switches;
  }
  ::closedir(tasks);
  return used;
}

void print(const char* key, const std::map<std::string, double>& values) {
  std::printf(", \"%s\": {", key);
  const char* comma = "";
  for (const auto& [name, value] : values) {
    std::printf("%s\"%s\": %.2f", comma, name.c_str(), value);
    comma = ", ";
  }
  std::printf("}");
}

Options parse(const std::vector<std::string>& words) {
  if (words.size() < 3) {
    std::fputs("usage: fake_wire damiao|dji COUNT SECONDS [--hog-us N] [PID]\n", stderr);
    std::exit(2);
  }
  Options options{words[0] == "dji", static_cast<unsigned>(std::stoul(words[1])), std::stoi(words[2]), 0, {}};
  for (std::size_t i = 3; i < words.size(); ++i) {
    if (words[i] == "--hog-us" && i + 1 < words.size())
      options.hog_ns = std::stoll(words[++i]) * 1000;
    else
      options.pid = words[i];
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse({argv + 1, argv + argc});
  std::vector<std::thread> workers;
  if (options.count > 0) workers.emplace_back(options.dji ? turnRotors : moveJoints, std::cref(options));
  if (options.hog_ns > 0) workers.emplace_back(hog, options.hog_ns);
  sleepUntil(now_ns() + kSettling);
  const auto before = threads(options.pid);
  double left = 0;
  const std::int64_t start = now_ns();
  std::thread spinner{[&left] { left = spin(); }};
  sleepUntil(start + std::int64_t{1000} * options.seconds * kMs);
  ended = true;
  spinner.join();
  const std::int64_t end = now_ns();
  const auto after = threads(options.pid);
  for (auto& worker : workers) worker.join();
  const double per_ms = 1e-3 * kMs / static_cast<double>(end - start);  // ns are instructions here
  std::printf("{\"busy_k\": %.2f", (static_cast<double>(end - start) - left) * per_ms);
  std::map<std::string, double> cost;
  std::map<std::string, double> switches;
  for (const auto& [name, use] : after) {
    const auto found = before.find(name);
    const Use was = found == before.end() ? Use{} : found->second;
    cost[name] = static_cast<double>(use.cpu_ns - was.cpu_ns) * per_ms;
    switches[name] =
        static_cast<double>(use.switches - was.switches) * kMs / static_cast<double>(end - start);
  }
  print("threads_k", cost);
  print("switches", switches);
  std::puts("}");
}
