#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "bus/byte_order.hpp"
#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_motor.hpp"
#include "support/frame_bytes.hpp"
#include "support/own_defaults.hpp"

/// Motors of LK-Tech, and what their drives answer.
namespace rc10::test::lktech_bench {

inline MotorSettings settingsOf(std::string model = "LK-MF9025", int id = 1, bool grouped = false) {
  MotorSettings settings;
  settings.name = "motor" + std::to_string(id);
  settings.model = std::move(model);
  settings.id = id;
  settings.own = ownDefaults(lktechFamily());
  settings.own.set("group", grouped ? 1.0 : 0.0);
  return settings;
}

inline std::unique_ptr<LKTech_Motor> motorOf(const MotorSettings& settings) {
  return std::make_unique<LKTech_Motor>(settings, lktechFamily().traits(settings.model, settings.own));
}

inline CanFrame readingReply(int current_raw, int rotor_deg_s, std::uint16_t encoder,
                             std::int8_t temperature_c = 30) {
  CanFrame frame = frameOf("141#A100000000000000");
  frame.data[1] = static_cast<std::uint8_t>(temperature_c);
  writeLittleEndian(frame.data, 2, static_cast<std::int16_t>(current_raw));
  writeLittleEndian(frame.data, 4, static_cast<std::int16_t>(rotor_deg_s));
  writeLittleEndian(frame.data, 6, encoder);
  return frame;
}

inline CanFrame angleReply(std::int64_t raw) {
  CanFrame frame = frameOf("141#0000000000000000");
  writeLittleEndian(frame.data, 0, static_cast<std::int64_t>(static_cast<std::uint64_t>(raw) << 8U | 0x92U));
  return frame;
}

}  // namespace rc10::test::lktech_bench
