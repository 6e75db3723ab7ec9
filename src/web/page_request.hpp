#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/vocabulary.hpp"

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

using PageRequest = std::variant<ShowToken, ChooseView, AskRange, AskRobot, DriveMotor, TellClock>;

/// A stranger's message. The error is a sentence for him.
[[nodiscard]] Result<PageRequest> parsePageRequest(std::string_view text);

}  // namespace rc10::web
