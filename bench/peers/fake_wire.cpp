// Drives of a robot as a wire would carry them, and what they leave of the computer. In a guest whose clock
// counts instructions, see guest.py:
//
//   fake_wire damiao|dji COUNT SECONDS [--hog-us N] [PID]
//
// COUNT drives on vcan0 (dji: on vcan1 too) send a frame each per millisecond, 110 us apart, from 150 us
// after the whole millisecond: an eight-byte frame at 1 Mbit/s. --hog-us: a FIFO-50 thread is busy for so
// long every 10 ms. Prints one JSON object: thousands of instructions per millisecond of the whole computer,
// and of the threads of process PID.
#include <dirent.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kFirstFrame = 150'000;
constexpr std::int64_t kSpacing = 110'000;
constexpr std::int64_t kHogPeriod = 10 * kMs;
// Programs of the script start, and rc10d enables its motors.
constexpr std::int64_t kSettling = 3000 * kMs;
constexpr int kDrivesPriority = 70;
constexpr int kHogPriority = 50;

std::atomic<bool> ended{false};

[[noreturn]] void fail(const char* what) {
  std::perror(what);
  std::_Exit(1);
}

std::int64_t now(clockid_t clock = CLOCK_MONOTONIC) {
  timespec time{};
  clock_gettime(clock, &time);
  return time.tv_sec * 1000 * kMs + time.tv_nsec;
}

void sleepUntil(std::int64_t time) {
  const timespec until{.tv_sec = time / (1000 * kMs), .tv_nsec = time % (1000 * kMs)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

void schedule(int policy, int priority) {
  const sched_param parameter{.sched_priority = priority};
  if (sched_setscheduler(0, policy, &parameter) != 0) fail("sched_setscheduler");
}

int openBus(const char* name) {
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(name));
  // It never reads, and so it must not receive.
  if (fd < 0 || address.can_ifindex == 0 || ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0) != 0 ||
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

can_frame feedback(const Options& options, unsigned drive, unsigned turn) {
  can_frame frame{};
  frame.can_dlc = 8;
  if (options.dji) {  // C620: rotor angle, speed, current, temperature
    frame.can_id = 0x201 + drive;
    const unsigned angle = turn * 40 % 8192;
    frame.data[0] = static_cast<__u8>(angle >> 8U);
    frame.data[1] = static_cast<__u8>(angle);
    frame.data[6] = 30;
  } else {  // DM4310: id and state (1: enabled), position, velocity and torque around their middles
    frame.can_id = 0x11 + drive;
    const unsigned position = 32768 + turn % 100 * 10;
    frame.data[0] = static_cast<__u8>((drive + 1) | 0x10U);
    frame.data[1] = static_cast<__u8>(position >> 8U);
    frame.data[2] = static_cast<__u8>(position);
    frame.data[3] = 0x80;
    frame.data[4] = 0x08;
    frame.data[6] = frame.data[7] = 30;
  }
  return frame;
}

void drive(const Options& options) {
  schedule(SCHED_FIFO, kDrivesPriority);
  std::vector<int> buses{openBus("vcan0")};
  if (options.dji) buses.push_back(openBus("vcan1"));
  std::int64_t start = (now() / kMs + 3) * kMs + kFirstFrame;
  for (unsigned turn = 0; !ended; ++turn, start += kMs) {
    for (unsigned i = 0; i < options.count; ++i) {
      sleepUntil(start + i * kSpacing);
      const can_frame frame = feedback(options, i, turn);
      for (const int bus : buses) (void)!::write(bus, &frame, sizeof frame);
    }
  }
}

void hog(std::int64_t busy_ns) {
  schedule(SCHED_FIFO, kHogPriority);
  for (std::int64_t start = (now() / kHogPeriod + 1) * kHogPeriod - busy_ns / 2; !ended;
       start += kHogPeriod) {
    sleepUntil(start);
    while (now() < start + busy_ns) {
    }
  }
}

// Takes what nobody else wants. Returns how much that was.
std::int64_t spin() {
  schedule(SCHED_IDLE, 0);
  const std::int64_t before = now(CLOCK_THREAD_CPUTIME_ID);
  volatile unsigned work = 0;
  while (!ended) work = work + 1;
  return now(CLOCK_THREAD_CPUTIME_ID) - before;
}

// CPU time of the threads of a process by name, in ns: the first field of schedstat.
std::map<std::string, std::int64_t> threads(const std::string& pid) {
  std::map<std::string, std::int64_t> times;
  const std::string folder = "/proc/" + pid + "/task";
  DIR* const tasks = pid.empty() ? nullptr : ::opendir(folder.c_str());
  if (tasks == nullptr) return times;
  while (const dirent* task = ::readdir(tasks)) {
    if (task->d_name[0] == '.') continue;  // ".." has the figures of the main thread once more
    std::string name;
    std::int64_t time = 0;
    std::getline(std::ifstream(folder + '/' + task->d_name + "/comm"), name);
    std::ifstream(folder + '/' + task->d_name + "/schedstat") >> time;
    if (!name.empty()) times[name] += time;
  }
  ::closedir(tasks);
  return times;
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
  if (options.count > 0) workers.emplace_back(drive, std::cref(options));
  if (options.hog_ns > 0) workers.emplace_back(hog, options.hog_ns);
  sleepUntil(now() + kSettling);
  const auto before = threads(options.pid);
  std::int64_t left = 0;
  const std::int64_t start = now();
  std::thread spinner{[&left] { left = spin(); }};
  sleepUntil(start + options.seconds * 1000 * kMs);
  ended = true;
  spinner.join();
  const std::int64_t end = now();
  const auto after = threads(options.pid);
  for (auto& worker : workers) worker.join();
  const double per_ms = 1e-3 * kMs / static_cast<double>(end - start);  // ns are instructions here
  std::printf("{\"busy_k\": %.2f, \"threads_k\": {", static_cast<double>(end - start - left) * per_ms);
  const char* comma = "";
  for (const auto& [name, time] : after) {
    const auto was = before.find(name);
    const std::int64_t used = time - (was == before.end() ? 0 : was->second);
    std::printf("%s\"%s\": %.2f", comma, name.c_str(), static_cast<double>(used) * per_ms);
    comma = ", ";
  }
  std::puts("}}");
}
