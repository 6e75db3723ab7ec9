#include "drives/dji/dji_wording.hpp"

#include <cstddef>
#include <cstdint>

#include "app/units.hpp"
#include "drives/dji/dji_frames.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10 {

std::string wordDji(const CanFrame& frame, std::string_view model, bool /*sent*/) {
  const auto* dji = findDjiModel(model);
  if (dji == nullptr || frame.id.extended || frame.fd || frame.length != dji::kLength) return {};
  const int id = static_cast<int>(frame.id.value) - dji->feedback_id_base;
  if (id >= 1 && id <= dji->max_id) {
    const auto told = dji::decodeFeedback(frame.payload());
    FrameWords words{id, "feedback"};
    words.add("encoder", told.encoder * kDegPerTurn / dji::kCountsPerTurn, "deg")
        .add("rotor", told.rotor_rpm, "rpm")
        .add(
            "current",
            told.current_raw * static_cast<double>(dji->feedback_full_scale_a) / dji->feedback_raw_full_scale,
            "A");
    if (dji->reports_temperature) words.add("temperature", told.temperature_c, "°C");
    return words.take();
  }
  for (const auto* table : {&dji->current, &dji->voltage}) {
    for (std::size_t half = 0; half < table->command_ids.size(); ++half) {
      if (!table->exists() || table->command_ids[half] == 0 || frame.id.value != table->command_ids[half])
        continue;
      FrameWords words{half == 0 ? "command of 1 to 4" : "command of 5 to 8"};
      for (std::size_t slot = 0; slot < dji::kGroupSize; ++slot)
        words.add({},
                  dji::decodeCommand(frame.payload(), slot) * static_cast<double>(table->full_scale) /
                      table->raw_full_scale,
                  table == &dji->current ? "A" : "V");
      return words.take();
    }
  }
  return {};
}

}  // namespace rc10
