#include "survey/drive_claims.hpp"

#include <algorithm>

#include "drives/families.hpp"
#include "survey/harmless_queries.hpp"

namespace rc10::survey {
namespace {

/// The frame may be the motor's, though its family is not known to send under this id.
bool maySend(const KnownMotor& motor, const CanFrame& frame) {
  const auto families = builtInFamilies();
  const auto entry = std::find_if(families.begin(), families.end(),
                                  [&](const FamilyEntry& each) { return each.family == motor.family; });
  return entry != families.end() && entry->speaks != nullptr && entry->speaks(frame, motor.id);
}

}  // namespace

bool DriveClaims::isStranger(const DriveGuess& guess) const {
  return std::find(strangers_.begin(), strangers_.end(), guess) != strangers_.end();
}

void DriveClaims::takeStranger(const DriveGuess& guess) {
  if (isStranger(guess)) return;
  strangers_.push_back(guess);
  for (auto& [claimed, claim] : claims_)
    if (claimed == guess && claim.assumed) claim.collides = true;
}

// An answer to a question goes to an id of the questioner's: there its drive counts by family and id.
void DriveClaims::take(const CanFrame& frame) {
  if (frame.type != FrameType::kData) return;
  const auto sender = std::find_if(motors_.begin(), motors_.end(),
                                   [&](const KnownMotor& motor) { return acceptsAny(motor.sends, frame); });
  std::vector<std::pair<DriveGuess, const MotorFamily*>> guesses;
  for (const auto& entry : builtInFamilies()) {
    std::vector<DriveGuess> of_family;
    if (entry.recognise != nullptr) entry.recognise(frame, of_family);
    for (const auto& guess : of_family) guesses.emplace_back(guess, entry.family);
  }
  const auto of_sender = [&](const auto& each) {
    return sender != motors_.end() && each.second == sender->family;
  };
  const bool own = std::any_of(guesses.begin(), guesses.end(), of_sender);
  // Models of one family may share ids: 0x205 is an M3508's 5 and a GM6020's 1.
  const bool exact = std::any_of(guesses.begin(), guesses.end(), [&](const auto& each) {
    return of_sender(each) && each.first.id == sender->id;
  });
  const bool fits_motor = sender != motors_.end() && !own && maySend(*sender, frame);
  if (fits_motor) {
    const auto index = static_cast<std::size_t>(sender - motors_.begin());
    const bool all_claimed_by_others = std::all_of(guesses.begin(), guesses.end(), [&](const auto& each) {
      const auto claim = of(each.first);
      return claim && claim->assumed && !claim->collides && claim->motor != index;
    });
    if (all_claimed_by_others) heard_without_guess_[index] = true;
  }
  for (const auto& each : guesses) {
    const auto& guess = each.first;
    const auto* family = each.second;
    if (guess.from_drive && sender == motors_.end()) takeStranger(guess);
    if (!guess.from_drive || of(guess).has_value()) continue;
    auto found = sender;
    if (found == motors_.end() && !guess.silent.empty())
      found = std::find_if(motors_.begin(), motors_.end(), [&](const KnownMotor& motor) {
        return motor.family == family && motor.id == guess.id;
      });
    if (found == motors_.end() || (own && family != sender->family)) continue;
    if (exact && guess.id != sender->id) continue;
    claims_.emplace_back(guess,
                         Claim{.motor = static_cast<std::size_t>(found - motors_.begin()),
                               .collides = family != found->family && (!fits_motor || isStranger(guess)),
                               .assumed = fits_motor});
  }
}

std::optional<DriveClaims::Claim> DriveClaims::of(const DriveGuess& guess) const {
  const auto found =
      std::find_if(claims_.begin(), claims_.end(), [&](const auto& claim) { return claim.first == guess; });
  return found == claims_.end() ? std::nullopt : std::optional{found->second};
}

std::vector<std::string> DriveClaims::unheard() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const bool heard = std::any_of(claims_.begin(), claims_.end(), [i](const auto& claim) {
      return claim.second.motor == i && !claim.second.collides;
    });
    if (!heard && !heard_without_guess_[i]) names.push_back(motors_[i].name);
  }
  return names;
}

std::string DriveClaims::commandedBy(const CanFrame& question) const {
  const auto found = std::find_if(motors_.begin(), motors_.end(), [&](const KnownMotor& motor) {
    return acceptsAny(motor.steers, question);
  });
  if (found != motors_.end()) return "motor '" + found->name + "'";
  const auto answered = std::find_if(motors_.begin(), motors_.end(), [&](const KnownMotor& motor) {
    return std::any_of(motor.steers.begin(), motor.steers.end(),
                       [&](const FrameFilter& filter) { return isAnsweredTo(question.id, filter.id); });
  });
  return answered == motors_.end() ? std::string{} : "motor '" + answered->name + "', by an answer";
}

}  // namespace rc10::survey
