#include "drives/dji/dji_recogniser.hpp"

#include <string_view>

#include "drives/dji/dji_frames.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10 {
namespace {

// C620 and C610 cannot be told apart by their frames: where one has the temperature the other has nothing.
constexpr std::string_view kC6xx = "DJI M3508 or M2006";
constexpr std::string_view kGm6020 = "DJI GM6020";

}  // namespace

// Feedback at 0x200 + id, of GM6020 at 0x204 + id; commands at the ids of the tables.
void recogniseDji(const CanFrame& frame, std::vector<DriveGuess>& guesses) {
  if (frame.id.extended || frame.length != dji::kLength || frame.fd) return;
  const auto of = [&](const DjiModel& model, std::string_view kind) {
    const int id = static_cast<int>(frame.id.value) - model.feedback_id_base;
    if (id >= 1 && id <= model.max_id && dji::decodeFeedback(frame.payload()).encoder < dji::kCountsPerTurn)
      guesses.push_back({kind, id});
    const auto commands = {model.current.command_ids, model.voltage.command_ids};
    for (const auto& ids : commands) {
      if (frame.id.value != 0 && (frame.id.value == ids[0] || frame.id.value == ids[1])) {
        guesses.push_back({kind, 0, false});
        return;
      }
    }
  };
  of(kM3508, kC6xx);
  of(kGM6020, kGm6020);
}

}  // namespace rc10
