#include "daemon/exchange/events.hpp"

#include "link/event_text.hpp"

namespace rc10 {

std::string describe(const Event& event) {
  return link::eventText(static_cast<std::int32_t>(event.code), event.value, event.extra,
                         event.client.view());
}

}  // namespace rc10
