#pragma once

#include <span>
#include <string>

#include "bus/can_frame.hpp"

namespace rc10::survey {

/// A frame in words, by the families of the drives on its bus: "DJI 3 feedback: rotor 1500 rpm, …". Several
/// readings are joined by " or "; empty: none of these families. `sent`: by rc10d.
[[nodiscard]] std::string frameWords(const CanFrame& frame, std::span<const std::string> models, bool sent);

}  // namespace rc10::survey
