#include "daemon/clients/until_its_end.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

#include <fmt/format.h>

namespace rc10 {

Result<bool> isAskedFor(const UntilItsEnd& wish, const link::Request& request, const Speaker& speaker) {
  const auto values =
      std::span(request.values).first(std::min<std::size_t>(request.value_count, link::kMaxValues));
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const auto& value) { return value.name.view() == wish.value; });
  if (found == values.end() || found->value == 0.0) return false;
  if (found->value != 1.0) return fail(fmt::format("{}: use 1, or 0 for {}", wish.value, wish.lasting));
  if (speaker.way != Speaker::Way::kSocket) {
    return fail(fmt::format("{}: nobody sees the end of an LCM client; leave it out, and {}", wish.value,
                            wish.instead));
  }
  return true;
}

}  // namespace rc10
