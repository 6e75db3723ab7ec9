#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/motion/curve.hpp"
#include "client/motion/motion_report.hpp"
#include "client/motion/motion_run.hpp"
#include "link/link_protocol.hpp"
#include "web/access.hpp"
#include "web/daemon_end.hpp"
#include "web/page_request.hpp"
#include "web/recordings.hpp"
#include "web/robot_feed.hpp"

namespace rc10::web {

/// Version of the messages between this server and its page, which come from one package: a page that was
/// loaded before an upgrade loads itself anew.
inline constexpr int kPageProtocol = 3;

// Messages to a page, one JSON object each with its "type".

[[nodiscard]] std::string helloMessage(PageRight right, std::string_view session_name);
/// rc10d is not there, and why.
[[nodiscard]] std::string downMessage(std::string_view reason, const DaemonEnd& end);
/// The robot: motors, modules with their inputs and outputs, readings of each tick.
[[nodiscard]] std::string robotMessage(const RobotFeed& feed);
[[nodiscard]] std::string stateMessage(const RobotFeed& feed, const link::State& state);
[[nodiscard]] std::string diagnosticsMessage(const RobotFeed& feed, const link::Diagnostics& diagnostics);
[[nodiscard]] std::string eventMessage(const link::Event& event);
/// Names of the signals of a view that are drawn, in the order of its frames, and those that are not: rc10d
/// does not know them, or the pages draw as many as it gives.
[[nodiscard]] std::string viewMessage(std::uint32_t view, const std::vector<std::string>& drawn,
                                      const std::vector<std::string>& unknown, std::int64_t dropped_ticks);
[[nodiscard]] std::string recordingsMessage(std::int64_t seq, const std::vector<RecordingFile>& files);
/// Words for the numbers of a recording, in the order of the question; "": not known.
[[nodiscard]] std::string wordsMessage(const AskWords& asked);
/// The robot's file, and whether a text would be accepted: all but the answer of the ConfigDesk and a
/// bracket.
[[nodiscard]] std::string configHead(std::int64_t seq, std::string_view of, std::string_view sha256);
[[nodiscard]] std::string checkedConfigHead(std::int64_t seq);
/// To the clock of a page: it knows by that that somebody listens.
[[nodiscard]] std::string clockMessage();
/// To a request of the page, by its own number. `heard`: by a scan.
[[nodiscard]] std::string responseMessage(std::int64_t seq, std::string_view status, std::string_view message,
                                          std::span<const link::NamedValue> values = {},
                                          std::span<const link::Sighting> heard = {});

/// A test of motion goes on.
[[nodiscard]] std::string testMessage(std::int64_t seq, double time_s, double lasts_s);
/// It is over, with its numbers as `rc10ctl test-motion --json` has them, and what its motor does.
[[nodiscard]] std::string testDoneMessage(std::int64_t seq, const client::MotionReport& report,
                                          const client::MotionRun& run, std::string_view doing);

/// Binary frame with ticks of a curve from `first` on, kMaxCurveTicks at most, little-endian: version u8,
/// kind u8, columns u16, ticks u32, 0 u32, 0 u32, the test's number f64, first f64; then all of each column,
/// f64: those of `rc10ctl test-motion --csv`.
inline constexpr std::size_t kMaxCurveTicks = 4096;
[[nodiscard]] std::vector<std::byte> curveFrame(const client::Curve& curve, std::int64_t seq,
                                                std::size_t first);

}  // namespace rc10::web
