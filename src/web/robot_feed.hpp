#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/link_client.hpp"
#include "client/module_text.hpp"
#include "web/trace_store.hpp"

namespace rc10::web {

/// The robot as the server knows it: one connection to rc10d for all pages. rc10d may end, and come back.
class RobotFeed {
 public:
  /// Without a name: the only robot of this computer.
  explicit RobotFeed(std::optional<std::string> robot);

  /// Connects, if it is not connected.
  void connect();
  [[nodiscard]] bool connected() const noexcept { return rc10d_.has_value(); }
  /// Reason why it is not.
  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }
  /// The socket that it is connected to, for connections of the pages' own.
  [[nodiscard]] const std::string& socketPath() const noexcept { return path_; }
  [[nodiscard]] int descriptor() const noexcept { return rc10d_ ? rc10d_->descriptor() : -1; }

  /// Takes everything that has arrived. False: rc10d has ended.
  [[nodiscard]] bool receive();
  /// An e-stop past connections, which may all be taken, for one of the pages. False: no rc10d takes it.
  [[nodiscard]] bool estop(std::string_view client);
  /// Signals of each tick from now on.
  void choose(std::span<const link::TraceSignal> signals);

  /// Only while it is connected.
  [[nodiscard]] const link::Welcome& welcome() const noexcept {
    return rc10d_->welcome();  // NOLINT(bugprone-unchecked-optional-access)
  }
  [[nodiscard]] std::vector<link::ModuleInfo> moduleInfos() const;
  [[nodiscard]] const std::vector<client::ModuleView>& modules() const noexcept { return modules_; }
  [[nodiscard]] const TraceStore& traces() const noexcept { return traces_; }
  [[nodiscard]] std::int64_t droppedTicks() const noexcept { return dropped_ticks_; }

  /// Whether the description of the robot is new since the last call: another robot, or more of a module is
  /// known.
  [[nodiscard]] bool takeRobotIsNew() noexcept;
  /// The newest state, once; null: none since the last call.
  [[nodiscard]] const link::State* takeState() noexcept;
  [[nodiscard]] const link::Diagnostics* takeDiagnostics() noexcept;
  /// Events since the last call; the last ones are kept for pages that come later.
  [[nodiscard]] std::vector<link::Event> takeEvents();
  [[nodiscard]] const std::deque<link::Event>& pastEvents() const noexcept { return past_events_; }

 private:
  void take(std::span<const std::byte> datagram);
  void forget();
  void traced(std::span<const link::TraceSignal> signals);

  std::optional<std::string> robot_;
  std::optional<LinkClient> rc10d_;
  std::string path_;
  std::string reason_;
  std::vector<std::byte> buffer_;
  link::State state_;
  link::Diagnostics diagnostics_;
  link::Trace trace_;
  bool robot_is_new_ = false;
  bool new_state_ = false;
  bool new_diagnostics_ = false;
  std::vector<client::ModuleView> modules_;
  std::vector<link::Event> new_events_;
  std::deque<link::Event> past_events_;
  TraceStore traces_;
  std::vector<link::TraceSignal> traced_;
  std::int64_t dropped_ticks_ = 0;
};

}  // namespace rc10::web
