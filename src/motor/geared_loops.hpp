#pragma once

#include "motor/cascade.hpp"

namespace rc10 {

/// The same loops for another shaft of the same rotor, which turns once in `turns` turns of the shaft that
/// `loops` are for: the rotor moves as before, in the other units. Above 0; 1 changes nothing.
[[nodiscard]] CascadeConfig loopsBehindGear(CascadeConfig loops, double turns) noexcept;

}  // namespace rc10
