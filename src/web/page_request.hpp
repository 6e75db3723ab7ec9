#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/vocabulary.hpp"
#include "client/file_request.hpp"
#include "client/motion/motion_plan.hpp"

namespace rc10::web {

// Messages from a page, one JSON object each with its "type".

struct ShowToken {
  std::string token;
};
/// The signals to be drawn from now on: the last `span_us`, then all that follow.
struct ChooseView {
  std::uint32_t view = 0;
  std::vector<std::string> signals;
  std::int64_t column_us = 0;
  std::int64_t span_us = 0;
};
/// Columns of the past, of the signals of the view.
struct AskRange {
  std::int64_t first_column = 0;
  std::int64_t column_us = 0;
  std::uint32_t count = 0;
};
/// An operation of rc10d, as rc10ctl's verbs send it.
struct AskRobot {
  std::int64_t seq = 0;
  /// By the page's clock. Empty: one that stops, which is never too late.
  std::optional<Duration> sent = std::nullopt;
  std::string operation;
  std::string target;
  std::vector<std::pair<std::string, double>> values;
};

/// Target of one motor while a pointer or a key is held: sent again and again, and once more when it is let
/// go.
struct DriveMotor {
  std::int64_t seq = 0;  ///< One number for all renewals of a hold.
  std::string motor;
  ControlMode mode{};
  double value = 0.0;
  Duration sent{};  ///< By the page's clock.
  bool held = false;
};

/// The page's clock, once a second.
struct TellClock {
  Duration sent{};
};

/// The names of the recordings of this computer.
struct AskRecordings {
  std::int64_t seq = 0;
};
/// A recording, of which the first piece follows. An earlier one is given up.
struct AskRecording {
  std::uint32_t number = 0;
  std::string name;
};
/// The next piece of it.
struct AskPiece {
  std::uint32_t number = 0;
};

/// Words for the numbers of a recording that the page has.
struct AskWords {
  static constexpr std::size_t kMostEvents = 256;
  /// All pages wait for the words of a frame, 0.2 to 0.3 ms each.
  static constexpr std::size_t kMostFrames = 64;
  struct Event {
    std::int32_t code = 0;
    std::int32_t value = 0;
    std::int32_t extra = 0;
    std::string client;
  };
  struct Frame {
    std::size_t bus = 0;  ///< Place in `buses`.
    bool sent = false;
    std::string text;  ///< As candump writes it: "201#0011223344556677".
  };
  std::int64_t seq = 0;
  std::vector<Event> events;
  std::vector<std::vector<std::string>> buses;  ///< The models of the drives of each bus.
  std::vector<Frame> frames;
};

/// The text of the robot's file.
struct AskConfig {
  std::int64_t seq = 0;
};
/// Whether rc10d would accept this text.
struct CheckConfig {
  static constexpr std::size_t kMostBytes = std::size_t{128} << 10U;
  std::int64_t seq = 0;
  std::string text;
};

/// The root helper is asked to install this text, or to restart rc10d.
struct ChangeFile {
  std::int64_t seq = 0;
  Duration sent{};  ///< By the page's clock.
  client::FileVerb verb = client::FileVerb::kInstall;
  std::string text;
  std::string replaces;  ///< SHA-256 of the text that it was made of; empty: of what config shows now.
};

/// A test of motion. It goes on as long as the page says so.
struct StartTest {
  static constexpr std::int64_t kSchema = 1;
  std::int64_t seq = 0;  ///< One number for all that concerns this test.
  Duration sent{};       ///< By the page's clock.
  client::MotionPlan plan;
  std::int32_t priority = 0;
};
struct RenewTest {
  std::int64_t seq = 0;
  Duration sent{};
};
enum class TestEnd : std::uint8_t { kStopped, kLeft };
struct EndTest {
  std::int64_t seq = 0;
  TestEnd why{};
};
/// Ticks of the curve of the last test, from this one on.
struct AskCurve {
  std::int64_t seq = 0;
  std::uint32_t first = 0;
};

using PageRequest = std::variant<ShowToken, ChooseView, AskRange, AskRobot, DriveMotor, TellClock,
                                 AskRecordings, AskRecording, AskPiece, AskWords, AskConfig, CheckConfig,
                                 ChangeFile, StartTest, RenewTest, EndTest, AskCurve>;

/// A stranger's message. The error is a sentence for him.
[[nodiscard]] Result<PageRequest> parsePageRequest(std::string_view text);
/// Number by which the page knows the answer to a message, one that is refused too; 0: it has none.
[[nodiscard]] std::int64_t numberOf(std::string_view text);

}  // namespace rc10::web
