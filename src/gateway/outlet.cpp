#include "gateway/outlet.hpp"

#include "app/utime.hpp"
#include "link/link_message.hpp"

namespace rc10::gateway {

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
  using enum link::MessageType;
  link::Header header;
  const auto type = link::readHeader(datagram, header) ? header.type : link::MessageType{};
  bool taken = false;
  switch (type) {
    case kState: taken = open<link::State>(datagram); break;
    case kDiagnostics: taken = open<link::Diagnostics>(datagram); break;
    case kEvent: taken = open<link::Event>(datagram); break;
    case kResponse: taken = open<link::Response>(datagram); break;
    case kModuleInfo: taken = open<link::ModuleInfo>(datagram); break;
    case kModuleState: taken = open<link::ModuleState>(datagram); break;
    default: break;
  }
  if (!taken) ++malformed_;
}

template <typename Message>
bool Outlet::open(std::span<const std::byte> datagram) {
  Message message;
  return link::open(datagram, message) && take(message);
}

bool Outlet::take(const link::State& state) {
  convert(welcome_, state, state_);
  send(state_channel_, state_);
  return true;
}

bool Outlet::take(const link::Diagnostics& diagnostics) {
  convert(diagnostics, diagnostics_);
  send(diagnostics_channel_, diagnostics_);
  return true;
}

bool Outlet::take(const link::Event& event) {
  publish(event);
  return true;
}

bool Outlet::take(const link::Response& response) {
  publish(response);
  return true;
}

bool Outlet::take(const link::ModuleInfo& info) {
  if (info.module >= modules_.size()) return false;
  modules_[info.module].info = info;
  return true;
}

void Outlet::publish(const link::Event& event) {
  convert(event, event_);
  send(event_channel_, event_);
}

void Outlet::publish(const link::Response& response) {
  convert(response, utimeOf(std::chrono::system_clock::now()), response_);
  send(response_channel_, response_);
}

bool Outlet::take(const link::ModuleState& state) {
  if (state.module >= modules_.size()) return false;
  const auto& [channel, info] = modules_[state.module];
  convert(info, state, signals_);
  send(channel, signals_);
  return true;
}

}  // namespace rc10::gateway
