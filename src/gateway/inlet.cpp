#include "gateway/inlet.hpp"

#include <algorithm>
#include <chrono>

#include "app/message_limits.hpp"
#include "app/utime.hpp"
#include "rc10_version.hpp"

namespace rc10::gateway {

Inlet::Inlet(LinkClient& rc10d, Outlet& outlet) : rc10d_(rc10d), outlet_(outlet) {
  const std::string prefix = std::string(rc10d.welcome().robot.view()) + ".v1.";
  command_channel_ = prefix + "command";
  request_channel_ = prefix + "request";
  const auto& welcome = rc10d_.welcome();
  for (std::size_t i = 0; i < welcome.module_count; ++i)
    module_channels_.push_back(prefix + std::string(welcome.modules[i].view()));
}

std::vector<std::string> Inlet::channels() const {
  std::vector<std::string> all{command_channel_, request_channel_};
  all.insert(all.end(), module_channels_.begin(), module_channels_.end());
  return all;
}

bool Inlet::handle(const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now,
                   link::Origin origin) {
  const auto module = std::find(module_channels_.begin(), module_channels_.end(), datagram.channel);
  const bool ours = datagram.channel == command_channel_ || datagram.channel == request_channel_ ||
                    module != module_channels_.end();
  if (!ours || datagram.kind == UdpmDatagram::Kind::kForeign) return true;
  if (datagram.kind == UdpmDatagram::Kind::kFragment) {
    reportDefect(Defect::kTooLarge, datagram.channel, now);
    return true;
  }
  command_.origin = request_.origin = signals_.origin = origin;
  if (datagram.channel == command_channel_) return command(datagram, received, now);
  if (datagram.channel == request_channel_) return request(datagram, received, now);
  return signals(static_cast<std::size_t>(module - module_channels_.begin()), datagram, received, now);
}

bool Inlet::command(const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now) {
  const Defect defect = decode(datagram.message, command_);
  if (defect != Defect::kNone) {
    reportDefect(defect, datagram.channel, now);
    return true;
  }
  command_.received_ns = received.time_since_epoch().count();
  return sent(rc10d_.send(command_), counters_.commands, now);
}

bool Inlet::request(const UdpmDatagram& datagram, MonotonicTime received, MonotonicTime now) {
  const auto [defect, identified, forgiven] = decode(datagram.message, request_);
  if (forgiven != Defect::kNone)
    reportDefect(forgiven, datagram.channel, now, "is an e-stop, and obeyed as such, but");
  if (defect != Defect::kNone) {
    reportDefect(defect, datagram.channel, now);
    if (identified) refuse(std::string("the request ") + inWords(defect));
    return true;
  }
  const auto operation = operationNamed(request_.operation.view());
  if (now - received > kMaxRequestAge && !(operation && stops(*operation))) {
    ++counters_.stale_requests;
    const auto age_ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - received).count();
    refuse("the request is " + std::to_string(age_ms) + " ms old, since rc10-lcm did not run: ask again");
    return true;
  }
  request_.received_ns = received.time_since_epoch().count();
  return sent(rc10d_.send(request_), counters_.requests, now);
}

bool Inlet::signals(std::size_t module, const UdpmDatagram& datagram, MonotonicTime received,
                    MonotonicTime now) {
  const Defect defect = decode(datagram.message, signals_);
  if (defect != Defect::kNone) {
    reportDefect(defect, datagram.channel, now);
    return true;
  }
  signals_.module = rc10d_.welcome().modules[module];
  signals_.received_ns = received.time_since_epoch().count();
  return sent(rc10d_.send(signals_), counters_.signals, now);
}

bool Inlet::sent(LinkClient::SendStatus status, std::uint64_t& counter, MonotonicTime now) {
  switch (status) {
    case LinkClient::SendStatus::kSent: ++counter; return true;
    case LinkClient::SendStatus::kBusy:
      ++counters_.busy;
      report(EventCode::kLinkBusy, Severity::kWarning,
             "rc10d does not take commands fast enough: they are dropped", now);
      return true;
    case LinkClient::SendStatus::kClosed: return false;
  }
  return false;
}

void Inlet::refuse(const std::string& reason) {
  link::Response response;
  response.client = request_.client;
  response.session = request_.session;
  response.seq = request_.seq;
  response.status = link::ResponseStatus::kRefused;
  response.message = reason;
  outlet_.publish(response);
}

void Inlet::reportDefect(Defect defect, std::string_view channel, MonotonicTime now, const char* verdict) {
  ++counters_.defective;
  const std::string type = channel == command_channel_   ? "command_t"
                           : channel == request_channel_ ? "request_t"
                                                         : "signals_t";
  if (defect == Defect::kOtherDefinitions) {
    report(EventCode::kOtherDefinitions, Severity::kError,
           "a client on channel " + std::string(channel) + " uses other definitions of " + type +
               ": regenerate its types from the lcm_types of rc10d " + kVersion,
           now);
    return;
  }
  report(EventCode::kMalformed, Severity::kWarning,
         "a message on channel " + std::string(channel) + ' ' + verdict + " it " + inWords(defect), now);
}

void Inlet::report(EventCode code, Severity severity, std::string text, MonotonicTime now) {
  const auto index = static_cast<std::size_t>(code) - static_cast<std::size_t>(EventCode::kOtherDefinitions);
  const auto held_back = throttles_[index].pass(now);
  if (!held_back) return;
  if (*held_back > 0) text += " (" + std::to_string(*held_back) + " more since the last report)";
  link::Event event;
  event.utime = utimeOf(std::chrono::system_clock::now());
  event.mono_us = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count();
  event.severity = severity;
  event.code = static_cast<std::int32_t>(code);
  event.source = "lcm";
  event.text = text;
  outlet_.publish(event);
}

}  // namespace rc10::gateway
