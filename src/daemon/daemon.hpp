#pragma once

#include <memory>
#include <string>
#include <vector>

#include <spdlog/logger.h>

#include "app/result.hpp"
#include "config/robot_config.hpp"
#include "daemon/clients/link_server.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/gateway_process.hpp"
#include "daemon/guard_process.hpp"
#include "daemon/interfaces/can_intake.hpp"
#include "daemon/interfaces/interface_locks.hpp"
#include "daemon/recording/black_box.hpp"
#include "daemon/signal_inbox.hpp"
#include "daemon/threads/gpio_loop.hpp"
#include "daemon/threads/io_loop.hpp"
#include "daemon/threads/line_loop.hpp"
#include "daemon/threads/rt_thread.hpp"
#include "daemon/threads/rx_loop.hpp"
#include "daemon/threads/sched_loop.hpp"
#include "daemon/threads/sim_loop.hpp"
#include "daemon/tick/scheduler.hpp"
#include "daemon/watchdog.hpp"

namespace rc10 {

/// The running process: builds everything, starts the threads in order, stops them in reverse.
/// Main thread only.
class Daemon {
 public:
  Daemon(RobotConfig config, std::shared_ptr<spdlog::logger> log);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  ~Daemon();

  /// Builds and starts. After an error nothing runs.
  [[nodiscard]] Result<void> start();
  /// Waits for a signal that means to stop, and looks after the gateway meanwhile.
  void waitForSignal(SignalInbox& signals);
  /// Rest frames until they are on the wire, then the end of every thread; prints the summary.
  void stop();

 private:
  [[nodiscard]] Result<void> build();
  [[nodiscard]] Result<void> prepareLinks();
  [[nodiscard]] Result<void> startThreads();
  [[nodiscard]] Result<void> startThread(RtThread& thread, RtSettings settings,
                                         std::function<void(std::stop_token)> body);
  [[nodiscard]] Result<void> tolerate(const Result<void>& outcome);
  [[nodiscard]] Result<void> createLoops(int estop_socket);
  [[nodiscard]] Result<void> findGuard();
  void tellWhoMayCommand();
  void superviseGuard();
  void describeRobot();
  void describeModules();
  [[nodiscard]] std::unique_ptr<SerialIo> serialIo();
  [[nodiscard]] std::unique_ptr<SpiKeeper> spiIo();
  void openBlackBox();
  [[nodiscard]] std::uint64_t newPageFaults() const;
  [[nodiscard]] ThreadFacts tickThread();
  void feedWatchdog();

  RobotConfig config_;
  std::shared_ptr<spdlog::logger> log_;
  UniqueFd cpu_latency_;
  RobotDescription description_;
  InterfaceLocks interface_locks_;  // longer than the sockets of the robot
  std::unique_ptr<Robot> robot_;
  std::vector<BusInbox> inboxes_;  // of each bus
  LinkExchange exchange_;
  std::unique_ptr<BlackBox> black_box_;  // null: off, or not to be had
  std::unique_ptr<GuardProcess> guard_;  // null: off, not to be had, or no drive on a CAN interface
  std::unique_ptr<Scheduler> scheduler_;
  std::unique_ptr<CanIntake> intake_;
  std::unique_ptr<SchedLoop> sched_loop_;
  std::unique_ptr<RxLoop> rx_loop_;
  std::optional<PhaseWatch> phase_watch_;  // for io_loop_
  std::unique_ptr<SimLoop> sim_loop_;
  std::unique_ptr<GpioLoop> gpio_loop_;
  std::unique_ptr<LineLoop> line_loop_;  // null: no module has GPIO lines
  std::unique_ptr<IoLoop> io_loop_;
  CpuRivals cpu_rivals_{config_.scheduler.priority};  // the link thread's
  std::unique_ptr<LinkServer> link_;
  std::unique_ptr<GatewayProcess> gateway_;
  Watchdog watchdog_;
  std::uint64_t page_faults_at_start_ = 0;
  UniqueFd sched_stat_;  ///< The scheduler thread's, see waitedForCpu().

  // Ended in reverse order of start: see stop().
  RtThread copy_thread_;
  RtThread io_thread_;
  RtThread link_thread_;
  RtThread sim_thread_;
  RtThread line_thread_;
  RtThread gpio_thread_;
  RtThread rx_thread_;
  RtThread sched_thread_;
};

}  // namespace rc10
