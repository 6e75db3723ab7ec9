#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include <spdlog/logger.h>

#include "app/result.hpp"
#include "blackbox/box_file.hpp"
#include "blackbox/history.hpp"
#include "daemon/recording/copy_plan.hpp"
#include "daemon/recording/flight_recorder.hpp"

namespace rc10 {

struct RobotDescription;

/// The black box of the running process: its file, who writes it, and who keeps copies of it.
class BlackBox {
 public:
  struct Settings {
    std::string run_dir;    ///< Folder of the file.
    std::string state_dir;  ///< Folder of the copies.
    int mib = 16;
  };

  /// Opens a new file. That of an earlier run which did not stop in good order is put aside, to be copied by
  /// runCopies(). Only who holds the robot's link socket may call it. Main thread, before the first tick.
  [[nodiscard]] static Result<std::unique_ptr<BlackBox>> create(const Settings& settings,
                                                                const RobotDescription& robot,
                                                                std::shared_ptr<spdlog::logger> log);

  /// For the scheduler.
  [[nodiscard]] FlightRecorder& recorder() noexcept { return recorder_; }

  /// Moves what was recorded to the history. io thread, some 100 times a second.
  void drain();
  /// The body of the thread that makes copies: it waits for the disk, and nobody waits for it. Ends with
  /// the copy that is still to be made.
  void runCopies(const std::stop_token& stop);
  /// Marks the file as that of a run which stopped in good order. Main thread, when all others have ended.
  void end();

 private:
  BlackBox(const Settings& settings, std::string robot, std::unique_ptr<blackbox::BoxFile> file,
           std::shared_ptr<spdlog::logger> log);

  [[nodiscard]] std::string asidePath() const { return file_->path() + ".crashed"; }
  void copyAside();
  void copy(const char* cause);
  void complain(const std::string& why);

  std::string robot_;
  std::string state_dir_;
  std::unique_ptr<blackbox::BoxFile> file_;
  blackbox::History history_;
  FlightRecorder recorder_;
  CopyPlan plan_;
  std::shared_ptr<spdlog::logger> log_;
  bool complained_ = false;
  bool history_lost_ = false;
  bool file_whole_ = true;  ///< Until somebody cuts it off. io thread's, at the end the main thread's.
};

}  // namespace rc10
