#include "web/page_link.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "client/request_call.hpp"

namespace rc10::web {
namespace {

// Requests without an answer yet: a page waits for its answers, and never needs as many.
constexpr std::size_t kMostOpen = 16;
constexpr Duration kPatience = std::chrono::milliseconds{200};
// Connecting to an rc10d that does not answer holds up all pages: renewals of a jog must not try it one
// after the other before the STOP behind them.
constexpr Duration kPause = std::chrono::milliseconds{500};
// rc10d answers within ticks. A person who presses STOP must soon learn that nobody has heard it.
constexpr Duration kAnswerPatience = std::chrono::seconds{5};
constexpr Duration kEstopPatience = std::chrono::milliseconds{500};
// A scan listens first: as long as it may, and asks at the pace of a slow and busy bus.
constexpr Duration kScanPatience = std::chrono::seconds{90};

[[nodiscard]] Duration patienceWith(std::string_view operation) {
  const auto known = operationNamed(operation);
  if (known == Operation::kEstop) return kEstopPatience;
  return known == Operation::kScan ? kScanPatience : kAnswerPatience;
}

}  // namespace

PageLink::PageLink(std::string client_name)
    : client_name_(std::move(client_name)), session_(randomSession()), buffer_(link::kMaxMessageSize) {}

void PageLink::showToken(std::string token) {
  if (token == token_) return;
  token_ = std::move(token);
  next_try_ = {};
  close();
}

std::string PageLink::connect(const std::string& socket_path) {
  if (rc10d_) return {};
  if (std::chrono::steady_clock::now() < next_try_) return why_not_;
  auto connection = LinkClient::connect(
      socket_path, {.name = client_name_, .subscriptions = 0, .token = token_, .timeout = kPatience});
  if (!connection) {
    next_try_ = std::chrono::steady_clock::now() + kPause;
    return why_not_ = connection.error().message;
  }
  rc10d_.emplace(std::move(*connection));
  return {};
}

std::string PageLink::outcome(LinkClient::SendStatus status) {
  switch (status) {
    case LinkClient::SendStatus::kSent: return {};
    case LinkClient::SendStatus::kBusy: return "rc10d does not read what it is asked";
    case LinkClient::SendStatus::kClosed: break;
  }
  rc10d_.reset();
  return "rc10d has ended";
}

std::string PageLink::drive(const DriveMotor& wanted, std::int32_t validity_ms) {
  if (!rc10d_) return "rc10d has ended";
  link::Command command;
  command.client = client_name_;
  command.session = session_;
  command.seq = ++seq_;
  command.validity_ms = validity_ms;
  command.setpoint_count = 1;
  command.setpoints[0].motor = wanted.motor;
  command.setpoints[0].target = {.mode = wanted.mode, .value = wanted.value};
  return outcome(rc10d_->send(command));
}

std::string PageLink::ask(const AskRobot& request, const std::string& socket_path, MonotonicTime now) {
  if (auto why = connect(socket_path); !why.empty()) return why;
  const bool estop = operationNamed(request.operation) == Operation::kEstop;
  if (open_.size() >= kMostOpen && !estop) return "too many requests have no answer yet";
  link::Request message;
  message.client = client_name_;
  message.session = session_;
  message.seq = ++seq_;
  message.operation = request.operation;
  message.target = request.target;
  for (const auto& [name, value] : request.values)
    message.values[message.value_count++] = link::NamedValue{.name = std::string_view{name}, .value = value};
  auto why = outcome(rc10d_->send(message));  // NOLINT(bugprone-unchecked-optional-access)
  if (why.empty())
    open_.push_back({.number = seq_,
                     .seq = request.seq,
                     .estop = estop,
                     .sent = now,
                     .patience = patienceWith(request.operation)});
  return why;
}

std::optional<PageLink::Answer> PageLink::answer(MonotonicTime now) {
  auto answer = answerOfRc10d();
  return answer ? answer : answerInItsPlace(now);
}

std::optional<PageLink::Answer> PageLink::answerOfRc10d() {
  while (rc10d_) {
    const auto received = rc10d_->receive(buffer_);
    if (received.status == LinkClient::ReceiveStatus::kNothing) return std::nullopt;
    if (received.status == LinkClient::ReceiveStatus::kClosed) {
      close();
      return std::nullopt;
    }
    link::Sighting sighting;
    if (link::open(received.datagram, sighting)) {
      take(sighting);
      continue;
    }
    Answer answer;
    if (!link::open(received.datagram, answer.response) || answer.response.session != session_) continue;
    const auto found = std::find_if(open_.begin(), open_.end(),
                                    [&](const auto& o) { return o.number == answer.response.seq; });
    if (found == open_.end()) continue;
    answer.seq = found->seq;
    answer.sightings = std::move(found->sightings);
    open_.erase(found);
    return answer;
  }
  return std::nullopt;
}

void PageLink::take(const link::Sighting& sighting) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const auto& open) {
    return sighting.session == session_ && sighting.seq == open.number;
  });
  if (found != open_.end()) found->sightings.push_back(sighting);
}

std::optional<PageLink::Answer> PageLink::answerInItsPlace(MonotonicTime now) {
  const auto found = std::find_if(open_.begin(), open_.end(),
                                  [&](const auto& o) { return !rc10d_ || now - o.sent >= o.patience; });
  if (found == open_.end()) return std::nullopt;
  Answer answer{.seq = found->seq, .response = {}};
  answer.response.status = link::ResponseStatus::kFailed;
  std::string why = rc10d_ ? "rc10d does not answer" : "the connection to rc10d ended before the answer";
  if (found->estop) why.insert(0, "the e-stop was sent and is not confirmed: ");
  answer.response.message = std::string_view{why};
  open_.erase(found);
  return answer;
}

}  // namespace rc10::web
