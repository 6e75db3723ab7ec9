// Messages of a page of a stranger: parsed or refused in words, within the bounds that the hub relies on.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

#include "client/motion/motion_plan.hpp"
#include "fuzz_input.hpp"
#include "link/link_protocol.hpp"
#include "web/columns_frame.hpp"
#include "web/page_request.hpp"

namespace {

using namespace rc10;
using fuzz::require;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  const auto request = web::parsePageRequest(text);
  if (!request) {
    require(!request.error().message.empty());
    return 0;
  }
  if (const auto* view = std::get_if<web::ChooseView>(&*request)) {
    require(view->signals.size() <= link::kMaxTraceSignals && view->column_us > 0 && view->span_us >= 0);
  } else if (const auto* range = std::get_if<web::AskRange>(&*request)) {
    require(range->count >= 1 && range->count <= web::kMaxColumns && range->first_column >= 0);
  } else if (const auto* drive = std::get_if<web::DriveMotor>(&*request)) {
    require(std::isfinite(drive->value) && !drive->motor.empty() && drive->motor.size() < sizeof(link::Name));
    require(drive->mode == ControlMode::kVelocity || drive->mode == ControlMode::kCurrent);
  } else if (const auto* test = std::get_if<web::StartTest>(&*request)) {
    require(!test->plan.motor.empty() && test->plan.motor.size() < sizeof(link::Name));
    const auto settings = client::settingsOf(test->plan, "page");
    if (settings) {
      require(settings->validity_ms >= 20 && settings->validity_ms <= 1000);
      require(std::isfinite(settings->criteria.velocity_max_rpm) && settings->criteria.current_max_a > 0.0);
    }
  } else if (const auto* words = std::get_if<web::AskWords>(&*request)) {
    require(words->events.size() <= web::AskWords::kMostEvents &&
            words->frames.size() <= web::AskWords::kMostFrames);
    for (const auto& frame : words->frames) require(frame.bus < words->buses.size());
  } else if (const auto* check = std::get_if<web::CheckConfig>(&*request)) {
    require(check->text.size() <= web::CheckConfig::kMostBytes && check->seq >= 0);
  } else if (const auto* ask = std::get_if<web::AskRobot>(&*request)) {
    require(ask->values.size() <= link::kMaxValues &&
            ask->operation.size() < sizeof(link::Request::operation));
  }
  return 0;
}
