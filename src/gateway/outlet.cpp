#include "gateway/outlet.hpp"

#include <chrono>

#include "link/link_message.hpp"

namespace rc10::gateway {
namespace {

std::int64_t wallClockUs() noexcept {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

Outlet::Outlet(const link::Welcome& welcome, LcmPublisher& publisher)
    : welcome_(welcome), publisher_(publisher) {
  const std::string prefix = std::string(welcome.robot.view()) + ".v1.";
  state_channel_ = prefix + "state";
  diagnostics_channel_ = prefix + "diagnostics";
  event_channel_ = prefix + "event";
  response_channel_ = prefix + "response";
  for (std::size_t i = 0; i < welcome.module_count; ++i)
    modules_.push_back({prefix + std::string(welcome.modules[i].view()) + ".state", {}});
}

void Outlet::forward(std::span<const std::byte> datagram) {
  link::Header header;
  link::State state;
  link::Diagnostics diagnostics;
  link::Event event;
  link::Response response;
  link::ModuleInfo info;
  link::ModuleState module;
  const auto type = link::readHeader(datagram, header) ? header.type : link::MessageType{};
  if (type == link::MessageType::kState && link::open(datagram, state)) {
    convert(welcome_, state, state_);
    send(state_channel_, state_);
  } else if (type == link::MessageType::kDiagnostics && link::open(datagram, diagnostics)) {
    convert(diagnostics, diagnostics_);
    send(diagnostics_channel_, diagnostics_);
  } else if (type == link::MessageType::kEvent && link::open(datagram, event)) {
    publish(event);
  } else if (type == link::MessageType::kResponse && link::open(datagram, response)) {
    publish(response);
  } else if (type == link::MessageType::kModuleInfo && link::open(datagram, info) &&
             info.module < modules_.size()) {
    modules_[info.module].info = info;
  } else if (type == link::MessageType::kModuleState && link::open(datagram, module) &&
             module.module < modules_.size()) {
    publish(module);
  } else {
    ++malformed_;
  }
}

void Outlet::publish(const link::Event& event) {
  convert(event, event_);
  send(event_channel_, event_);
}

void Outlet::publish(const link::Response& response) {
  convert(response, wallClockUs(), response_);
  send(response_channel_, response_);
}

void Outlet::publish(const link::ModuleState& state) {
  const auto& [channel, info] = modules_[state.module];
  convert(info, state, signals_);
  send(channel, signals_);
}

}  // namespace rc10::gateway
