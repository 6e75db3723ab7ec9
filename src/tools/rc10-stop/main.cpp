// rc10-stop: the last word to the drives of an rc10d that was killed. It sends the rest frames that rc10d
// left in a file, and knows nothing else: no configuration, no protocol, no threads.

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "app/nearest.hpp"
#include "app/printable.hpp"
#include "app/standard_output.hpp"
#include "app/stderr_lines.hpp"
#include "app/whole_file.hpp"
#include "bus/frame_text.hpp"
#include "interface_stop.hpp"
#include "link/interface_lock.hpp"
#include "link/process_identity.hpp"
#include "link/run_dir.hpp"
#include "rc10_version.hpp"

namespace rc10 {
namespace {

constexpr int kOk = 0;
constexpr int kInterfaceFailed = 1;
constexpr int kBadUsageOrFile = 2;

// Together 0.2 s at most, and 0.1 s before for an rc10d that has been killed and is not gone yet: a service
// manager waits for us.
constexpr int kMaxSteps = 200;
constexpr auto kStep = std::chrono::milliseconds{1};
constexpr int kEndingSteps = 100;

constexpr std::string_view kHelp = R"(usage: rc10-stop ROBOT | --file FILE | --all   [--force]

Sends the drives of a robot the rest frames (no torque) that its rc10d left in
<run folder>/ROBOT/rest-frames. For when rc10d was killed or has crashed: systemd runs it then.
While rc10d runs it refuses: use `rc10ctl estop`.

  ROBOT        name of the robot
  --file FILE  replay this file: lines such as `can0 200#0000000000000000`
  --all        every robot of the run folder whose rc10d does not run any more
  --force      send even on an interface that a running rc10d drives
  --help, --version

RC10_RUN_DIR replaces /run/rc10d.
Exit status: 0 every frame was accepted, 1 an interface failed, or was left out because an rc10d drives it,
2 bad usage or file.
)";

constexpr std::array<std::string_view, 5> kOptions{"--file", "--all", "--force", "--help", "--version"};

struct Options {
  std::vector<std::string> files;
  std::string robot;  ///< If one was named.
  bool all = false;
  bool force = false;
};

// Other drives still wait for their frames: nobody waits for the reader of a line.
int complain(const std::string& message) {
  static const StderrLines kLines;
  (void)kLines.tell("rc10-stop: " + printable(message));
  return kBadUsageOrFile;
}

// It ends by itself, within 0.3 s: a closed terminal, Ctrl-C or a reader that has gone come too early.
void ignoreSignals() noexcept {
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGPIPE, SIGTTIN, SIGTTOU, SIGXFSZ})
    ::signal(signal, SIG_IGN);
}

bool isRobotName(std::string_view name) {
  return !name.empty() &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string_view::npos;
}

/// Every robot that ever ran here.
std::vector<std::string> allRobots() {
  std::vector<std::string> robots;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(link::runDir(), none)) {
    auto robot = entry.path().filename().string();
    if (std::filesystem::exists(link::restFramesPath(link::runDir(), robot), none))
      robots.push_back(std::move(robot));
  }
  std::sort(robots.begin(), robots.end());
  return robots;
}

std::vector<std::string> filesOf(const std::vector<std::string>& robots) {
  std::vector<std::string> files;
  files.reserve(robots.size());
  for (const auto& robot : robots) files.push_back(link::restFramesPath(link::runDir(), robot));
  return files;
}

/// "; robots that ran here: hero; did you mean hero?" for one that has left no file.
std::string othersThan(const std::string& robot) {
  const auto robots = allRobots();
  if (robots.empty() || std::find(robots.begin(), robots.end(), robot) != robots.end()) return {};
  std::string names;
  for (const auto& other : robots) names += (names.empty() ? "" : ", ") + other;
  return "; robots that ran here: " + names + didYouMean(robot, {robots.begin(), robots.end()});
}

/// Nothing: the message has been printed.
std::optional<Options> parse(const std::vector<std::string>& words) {
  Options options;
  int choices = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& word = words[i];
    if (word == "--force") {
      options.force = true;
    } else if (word == "--all") {
      options.all = true;
      ++choices;
    } else if (word == "--file" && i + 1 < words.size()) {
      options.files.push_back(words[++i]);
      ++choices;
    } else if (word == "--file") {
      complain("--file needs a FILE; --help explains");
      return std::nullopt;
    } else if (isRobotName(word) && word.front() != '-') {
      options.files.push_back(link::restFramesPath(link::runDir(), word));
      options.robot = word;
      ++choices;
    } else {
      complain("'" + word + "' is no robot and no option" +
               didYouMean(word, {kOptions.begin(), kOptions.end()}) + "; --help lists them");
      return std::nullopt;
    }
  }
  if (choices != 1) {
    complain("name one robot, or --file FILE, or --all; --help explains");
    return std::nullopt;
  }
  if (options.all) options.files = filesOf(allRobots());
  return options;
}

struct RestFile {
  std::optional<link::ProcessIdentity>
      writer;  ///< The rc10d that left it; a file of other programs has none.
  std::map<std::string, std::vector<CanFrame>> frames;  ///< By interface.
};

Result<RestFile> load(const std::string& path) {
  const auto text = readWholeFile(path);
  if (!text) return fail(path + ": cannot be read: no rc10d of that robot ran, or another user's did");
  const auto frames = parseFrameList(*text);
  if (!frames) return fail(path + ": " + frames.error().message);
  RestFile file{.writer = link::ProcessIdentity::in(*text), .frames = {}};
  for (const auto& [interface, frame] : *frames) file.frames[interface].push_back(frame);
  return file;
}

class Stop {
 public:
  explicit Stop(const Options& options) : options_(options) {}

  int run() {
    ignoreSignals();
    for (const auto& path : options_.files) {
      const auto file = load(path);
      if (file) {
        add(*file);
      } else {
        // The other robots have their drives too.
        status_ = complain(file.error().message + (options_.robot.empty() ? "" : othersThan(options_.robot)));
      }
    }
    std::vector<InterfaceStop> stops;
    stops.reserve(frames_.size());
    for (auto& [interface, frames] : frames_) stops.emplace_back(interface, std::move(frames));
    send(stops);
    for (const auto& stop : stops) {
      if (const auto problem = stop.problem(); !problem.empty()) failed(problem);
    }
    return status_;
  }

 private:
  void add(const RestFile& file) {
    for (const auto& [interface, frames] : file.frames) {
      if (!mayUse(interface, file.writer)) continue;
      auto& all = frames_[interface];
      all.insert(all.end(), frames.begin(), frames.end());
    }
  }

  bool mayUse(const std::string& interface, const std::optional<link::ProcessIdentity>& writer) {
    if (options_.force) return true;
    auto holder = link::holderOfInterface(interface);
    if (holder.empty()) return true;
    if (writer && writer->runs()) {
      if (options_.all) return false;  // it looks after its drives, and is none of those we were asked for
      for (; ending_steps_ > 0 && !holder.empty(); --ending_steps_) {
        std::this_thread::sleep_for(kStep);
        holder = link::holderOfInterface(interface);
      }
      if (holder.empty()) return true;
    }
    failed(interface + " is driven by " + holder +
           ", which runs: use `rc10ctl estop`, or --force to send all the same");
    return false;
  }

  static void send(std::vector<InterfaceStop>& stops) {
    for (int step = 0; step < kMaxSteps; ++step) {
      if (step != 0) std::this_thread::sleep_for(kStep);
      for (auto& stop : stops) stop.step();
      if (std::all_of(stops.begin(), stops.end(), [](const auto& stop) { return stop.ended(); })) return;
    }
  }

  void failed(const std::string& message) {
    complain(message);
    status_ = std::max(status_, kInterfaceFailed);
  }

  const Options& options_;
  std::map<std::string, std::vector<CanFrame>> frames_;
  int ending_steps_ = kEndingSteps;  ///< Shared by all interfaces.
  int status_ = kOk;
};

int runProgram(const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), "--help") != words.end()) {
    std::cout << kHelp;
    return kOk;
  }
  if (std::find(words.begin(), words.end(), "--version") != words.end()) {
    std::cout << "rc10-stop " << kVersion << '\n';
    return kOk;
  }
  const auto options = parse(words);
  return options ? Stop{*options}.run() : kBadUsageOrFile;
}

}  // namespace
}  // namespace rc10

int main(int argc, char** argv) {
  try {
    return rc10::statusOfOutput("rc10-stop", rc10::runProgram({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    return rc10::complain(error.what());
  }
}
