#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

#include "blackbox/copies.hpp"
#include "blackbox/image.hpp"
#include "blackbox/places.hpp"
#include "blackbox/recording.hpp"
#include "client/candump_line.hpp"
#include "client/find_robot.hpp"
#include "client/json_line.hpp"
#include "client/recording_json.hpp"
#include "client/recording_text.hpp"
#include "link/run_dir.hpp"
#include "verbs.hpp"

namespace rc10::ctl {
namespace {

namespace fs = std::filesystem;

struct Wish {
  std::string file;
  bool candump = false;
  std::string out;
};

using Line = std::function<bool(const std::string& line)>;

/// Without a name: that of the only robot that has one here, also when its rc10d has ended; of several,
/// that of the one that runs.
Result<std::string> liveFile(const Global& global) {
  const auto dir = link::runDir();
  if (global.robot) return blackbox::livePath(dir, *global.robot);
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator entry(dir, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() != ".blackbox") continue;
    if (!blackbox::isCopy(entry->path().filename().string())) found.push_back(entry->path().string());
  }
  if (found.size() == 1) return found.front();
  if (found.empty()) {
    return fail("no black box in " + dir + ": name a file; copies are in " + blackbox::stateDir());
  }
  const auto robot = findRobot(std::nullopt);
  if (!robot)
    return fail("several robots have a black box in " + dir + ": give --robot NAME, or name a file");
  return blackbox::livePath(dir, robot->robot);
}

Result<blackbox::Recording> load(const std::string& path) {
  const auto image = blackbox::readImage(path);
  if (!image) return tl::unexpected(image.error());
  auto recording = blackbox::Recording::parse(*image);
  if (!recording) return fail(path + ": " + recording.error().message);
  return recording;
}

void eachCandumpLine(const blackbox::Recording& recording, const Line& line) {
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const auto record = recording.at(i);
    const auto* frame = std::get_if<blackbox::Frame>(&record);
    // Frames that the kernel refused never were on the bus.
    if (frame == nullptr || (frame->header.flags & blackbox::kFrameRefused) != 0) continue;
    if (!line(client::candumpLine(recording, *frame))) return;
  }
}

void eachJsonLine(const blackbox::Recording& recording, const Line& line) {
  if (!line(client::recordingJson(recording))) return;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (!line(client::recordJson(recording, recording.at(i)))) return;
  }
}

/// `each` goes through the lines and stops where one cannot be written.
bool printLines(std::FILE* to, const std::function<void(const Line&)>& each) {
  bool good = true;
  each([&](const std::string& line) {
    good = std::fputs(line.c_str(), to) >= 0 && std::fputc('\n', to) != EOF;
    return good && !interrupted();
  });
  return std::fflush(to) == 0 && good;
}

Error notWritten(const fs::path& path, const std::string& why) {
  return {path.string() + " cannot be written: " + why + ": name another folder with --out"};
}

Result<std::string> save(const fs::path& path, const std::function<void(const Line&)>& each) {
  std::FILE* const file = std::fopen(path.c_str(), "we");
  if (file == nullptr) return tl::unexpected(notWritten(path, std::strerror(errno)));
  const bool printed = printLines(file, each);
  const int error = errno;
  const bool closed = std::fclose(file) == 0;
  if (interrupted()) return fail("interrupted: " + path.string() + " is not whole");
  if (!printed || !closed) return tl::unexpected(notWritten(path, std::strerror(printed ? errno : error)));
  return path.string();
}

ExitCode saveBoth(const Global& global, const blackbox::Recording& recording, const std::string& file,
                  const std::string& dir) {
  const auto base = fs::path(dir) / fs::path(file).stem();
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) return complain(notWritten(dir, error.message()), ExitCode::kFailed);
  const auto log = save(base.string() + ".log", [&](const Line& line) { eachCandumpLine(recording, line); });
  if (!log) return complain(log.error(), ExitCode::kFailed);
  const auto json = save(base.string() + ".jsonl", [&](const Line& line) { eachJsonLine(recording, line); });
  if (!json) return complain(json.error(), ExitCode::kFailed);
  if (global.json)
    std::puts(client::lineOf({{"files", {*log, *json}}}).c_str());
  else
    std::printf("%s\n%s\n", log->c_str(), json->c_str());
  return ExitCode::kOk;
}

ExitCode blackbox(const Global& global, const Wish& wish) {
  if (wish.candump && global.json)
    return complain({"--candump is a format of its own: leave out --json, or --candump"}, ExitCode::kUsage);
  std::string file = wish.file;
  if (file.empty()) {
    const auto live = liveFile(global);
    if (!live) return complain(live.error(), ExitCode::kFailed);
    file = *live;
  }
  const auto recording = load(file);
  if (!recording) return complain(recording.error(), ExitCode::kFailed);
  if (!wish.out.empty()) return saveBoth(global, *recording, file, wish.out);
  const auto pid = recording->header().pid;
  const bool running = pid > 0 && (::kill(pid, 0) == 0 || errno == EPERM);
  const bool printed = printLines(stdout, [&](const Line& line) {
    if (wish.candump) {
      eachCandumpLine(*recording, line);
    } else if (global.json) {
      eachJsonLine(*recording, line);
    } else {
      auto text = client::recordingText(*recording, running);
      text.pop_back();
      (void)line(text);
    }
  });
  return printed ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addBlackbox(CLI::App& app, Action& action) {
  const auto wish = std::make_shared<Wish>();
  auto* verb = app.add_subcommand(
      "blackbox", "what happened in the last minute: frames, commands, states, events (--json: all of it)");
  verb->add_option("file", wish->file, "a black box; default: that of the running robot")->type_name("FILE");
  auto* candump = verb->add_flag("--candump", wish->candump, "the frames as a candump log, for canplayer");
  verb->add_option("--out", wish->out, "writes DIR/<name>.log (candump) and DIR/<name>.jsonl")
      ->type_name("DIR")
      ->excludes(candump);
  verb->callback(
      [&action, wish] { action = [wish](const Global& global) { return blackbox(global, *wish); }; });
}

}  // namespace rc10::ctl
