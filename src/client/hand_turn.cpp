#include "client/hand_turn.hpp"

#include <algorithm>
#include <cmath>

#include "app/printable.hpp"
#include "app/units.hpp"
#include "client/first_spin.hpp"
#include "client/quantity_text.hpp"

namespace rc10::client {
namespace {

// A shaft that was touched, or the play of a gearbox.
constexpr double kNothingDeg = 20.0;
// A hand stops within some 20 degrees of a mark; the ratios of gearboxes of one size differ by more (1, 19.2,
// 36).
constexpr double kHandError = 0.1;

double turned(const link::State& before, const link::State& after, std::size_t motor) {
  const double difference = after.motors[motor].total_angle_deg - before.motors[motor].total_angle_deg;
  return std::isfinite(difference) ? difference : 0.0;
}

}  // namespace

HandTurn judgeHandTurn(const link::State& before, const link::State& after, std::size_t motor,
                       bool angle_lost) {
  const auto count = std::min<std::size_t>({before.motor_count, after.motor_count, link::kMaxMotors});
  HandTurn turn;
  turn.moved = motor;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(turned(before, after, i)) > std::abs(turned(before, after, turn.moved))) turn.moved = i;
  }
  turn.turned_deg = turned(before, after, turn.moved);
  const double own_deg = turned(before, after, motor);
  if (angle_lost) {
    turn.outcome = HandTurn::Outcome::kAngleLost;
  } else if (std::abs(turn.turned_deg) < kNothingDeg) {
    turn.outcome = HandTurn::Outcome::kNotTurned;
  } else if (turn.moved != motor && std::abs(own_deg) < kNothingDeg) {
    turn.outcome = HandTurn::Outcome::kOtherMotor;
  } else {
    turn.moved = motor;
    turn.turned_deg = own_deg;
    turn.ratio_factor = std::abs(own_deg) / kDegPerTurn;
    if (std::abs(turn.ratio_factor - 1.0) > kHandError)
      turn.outcome = HandTurn::Outcome::kWrongRatio;
    else if (own_deg < 0.0)
      turn.outcome = HandTurn::Outcome::kWrongSign;
  }
  return turn;
}

std::string text(const HandTurn& turn, const link::Welcome& welcome, std::size_t motor) {
  const std::string name = printable(welcome.motors[motor].name.view());
  const std::string other = printable(welcome.motors[turn.moved].name.view());
  std::string found = other + " turned by " + number(turn.turned_deg, 1) + " deg";
  switch (turn.outcome) {
    case HandTurn::Outcome::kGood: return found + ": name, sign and ratio are right";
    case HandTurn::Outcome::kNotTurned:
      return "no motor turned: was it a whole turn? Is " + name + " online (`rc10ctl watch`)?";
    case HandTurn::Outcome::kOtherMotor:
      return found + ", and " + name + " did not: swap their ids (or buses) in the configuration";
    case HandTurn::Outcome::kWrongSign:
      return found + ", clockwise: set `direction: -1` for " + name + " (or take it away)";
    case HandTurn::Outcome::kAngleLost: return angleLost(name);
    case HandTurn::Outcome::kWrongRatio:
      return found + " instead of 360: if it was one whole turn, multiply `gear_ratio` of " + name + " by " +
             number(turn.ratio_factor, 3);
  }
  return found;
}

}  // namespace rc10::client
