#pragma once

#include <cstddef>
#include <string>

#include "link/link_protocol.hpp"

namespace rc10::client {

/// Check of the configuration by turning a motor's output by hand, one whole turn counter-clockwise.
struct HandTurn {
  enum class Outcome : unsigned char {
    kGood,
    kNotTurned,   ///< Nothing moved.
    kOtherMotor,  ///< Another one moved: the names or ids are swapped.
    kWrongSign,
    kWrongRatio,
    kAngleLost,  ///< Its feedback had a gap that may hide a turn.
  };
  Outcome outcome = Outcome::kGood;
  std::size_t moved = 0;      ///< The motor that moved most, its place in Welcome.
  double turned_deg = 0.0;    ///< Turn that it reports.
  double ratio_factor = 1.0;  ///< kWrongRatio: what the configured gear ratio has to be multiplied by.
};

/// `before` and `after`: the states at both ends of the turn; `motor`: the one that was meant; `angle_lost`:
/// event 102 came of it between them.
[[nodiscard]] HandTurn judgeHandTurn(const link::State& before, const link::State& after, std::size_t motor,
                                     bool angle_lost);

/// Result and remedy in words.
[[nodiscard]] std::string text(const HandTurn& turn, const link::Welcome& welcome, std::size_t motor);

}  // namespace rc10::client
