#include "drives/dji/dji_wording.hpp"

#include <cstddef>
#include <cstdint>

#include "bus/byte_order.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10 {

std::string wordDji(const CanFrame& frame, std::string_view model, bool /*sent*/) {
  const auto* dji = findDjiModel(model);
  if (dji == nullptr || frame.id.extended || frame.fd || frame.length != 8) return {};
  const auto raw = [&](std::size_t at) { return readBigEndian<std::int16_t>(frame.payload(), at); };
  const int id = static_cast<int>(frame.id.value) - dji->feedback_id_base;
  if (id >= 1 && id <= dji->max_id) {
    const double turn = dji->encoder.counts_per_turn;
    FrameWords words{id, "feedback"};
    words.add("encoder", readBigEndian<std::uint16_t>(frame.payload(), 0) * 360.0 / turn, "deg")
        .add("rotor", raw(2), "rpm")
        .add("current",
             raw(4) * static_cast<double>(dji->feedback_full_scale_a) / dji->feedback_raw_full_scale, "A");
    if (dji->reports_temperature) words.add("temperature", frame.data[6], "°C");
    return words.take();
  }
  for (const auto* table : {&dji->current, &dji->voltage}) {
    for (std::size_t half = 0; half < table->command_ids.size(); ++half) {
      if (!table->exists() || table->command_ids[half] == 0 || frame.id.value != table->command_ids[half])
        continue;
      FrameWords words{half == 0 ? "command of 1 to 4" : "command of 5 to 8"};
      for (std::size_t slot = 0; slot < 4; ++slot)
        words.add({}, raw(2 * slot) * static_cast<double>(table->full_scale) / table->raw_full_scale,
                  table == &dji->current ? "A" : "V");
      return words.take();
    }
  }
  return {};
}

}  // namespace rc10
