#include "web/robot_feed.hpp"

#include <algorithm>
#include <utility>

#include "client/find_robot.hpp"
#include "link/estop_datagram.hpp"

namespace rc10::web {
namespace {

// A minute of ticks at 1 kHz.
constexpr std::size_t kTraceRows = 60'000;
constexpr std::size_t kPastEvents = 200;
constexpr int kMessagesPerTurn = 256;
// Pages wait while rc10d is asked: one that listens answers at once.
constexpr Duration kGreetingPatience = std::chrono::milliseconds{200};

}  // namespace

RobotFeed::RobotFeed(std::optional<std::string> robot)
    : robot_(std::move(robot)), buffer_(link::kMaxMessageSize), traces_(kTraceRows) {}

void RobotFeed::connect() {
  if (rc10d_) return;
  const auto found = findRobot(robot_);
  if (!found) {
    reason_ = found.error().message;
    return;
  }
  auto connection = LinkClient::connect(
      found->path, {.name = link::kWebClient,
                    .subscriptions = link::kStates | link::kDiagnosticsFeed | link::kEvents | link::kModules,
                    .timeout = kGreetingPatience});
  if (!connection) {
    reason_ = connection.error().message;
    return;
  }
  path_ = found->path;
  rc10d_.emplace(std::move(*connection));
  rc10d_->prepareEstop();
  modules_.resize(std::min<std::size_t>(welcome().module_count, link::kMaxModules));
  for (std::size_t i = 0; i < modules_.size(); ++i) modules_[i].name = welcome().modules[i];
  traces_.clear();
  traced_.clear();
  robot_is_new_ = true;
}

bool RobotFeed::receive() {
  for (int i = 0; rc10d_ && i < kMessagesPerTurn; ++i) {
    const auto received = rc10d_->receive(buffer_);
    if (received.status == LinkClient::ReceiveStatus::kNothing) return true;
    if (received.status == LinkClient::ReceiveStatus::kClosed) {
      forget();
      return false;
    }
    take(received.datagram);
  }
  return rc10d_.has_value();
}

bool RobotFeed::estop(std::string_view client) {
  if (rc10d_ && rc10d_->sendEstop(client)) return true;
  const auto found = findRobot(robot_);
  return found && link::EstopDatagram::to(found->path).send(client);
}

void RobotFeed::forget() {
  rc10d_.reset();
  reason_ = "rc10d has ended";
  modules_.clear();
  new_state_ = new_diagnostics_ = false;
}

void RobotFeed::take(std::span<const std::byte> datagram) {
  link::Header header;
  if (!link::readHeader(datagram, header)) return;
  switch (header.type) {
    case link::MessageType::kState: new_state_ = link::open(datagram, state_) || new_state_; return;
    case link::MessageType::kDiagnostics:
      new_diagnostics_ = link::open(datagram, diagnostics_) || new_diagnostics_;
      return;
    case link::MessageType::kEvent: {
      link::Event event;
      if (!link::open(datagram, event)) return;
      new_events_.push_back(event);
      past_events_.push_back(event);
      if (past_events_.size() > kPastEvents) past_events_.pop_front();
      return;
    }
    case link::MessageType::kModuleInfo: {
      link::ModuleInfo info;
      if (!link::open(datagram, info) || info.module >= modules_.size()) return;
      modules_[info.module].info = info;
      robot_is_new_ = true;
      return;
    }
    case link::MessageType::kModuleState: {
      link::ModuleState state;
      if (link::open(datagram, state) && state.module < modules_.size()) modules_[state.module].state = state;
      return;
    }
    case link::MessageType::kTrace: {
      if (!link::open(datagram, trace_)) return;
      dropped_ticks_ = trace_.dropped;
      traced(std::span{trace_.signals}.first(trace_.signal_count));
      for (const auto& row : std::span{trace_.rows}.first(trace_.row_count)) traces_.add(row);
      return;
    }
    default: return;
  }
}

// Another client of rc10d may have changed what is traced for all.
void RobotFeed::traced(std::span<const link::TraceSignal> signals) {
  if (std::equal(signals.begin(), signals.end(), traced_.begin(), traced_.end())) return;
  traced_.assign(signals.begin(), signals.end());
  traces_.choose(signals);
}

void RobotFeed::choose(std::span<const link::TraceSignal> signals) {
  if (!rc10d_) return;
  link::TraceChoice choice;
  choice.signal_count = static_cast<std::uint32_t>(std::min(signals.size(), choice.signals.size()));
  std::copy_n(signals.begin(), choice.signal_count, choice.signals.begin());
  (void)rc10d_->send(choice);
}

std::vector<link::ModuleInfo> RobotFeed::moduleInfos() const {
  std::vector<link::ModuleInfo> infos;
  infos.reserve(modules_.size());
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    infos.push_back(modules_[i].info);
    infos.back().module = static_cast<std::uint32_t>(i);
  }
  return infos;
}

bool RobotFeed::takeRobotIsNew() noexcept { return std::exchange(robot_is_new_, false); }
const link::State* RobotFeed::takeState() noexcept {
  return std::exchange(new_state_, false) ? &state_ : nullptr;
}
const link::Diagnostics* RobotFeed::takeDiagnostics() noexcept {
  return std::exchange(new_diagnostics_, false) ? &diagnostics_ : nullptr;
}
std::vector<link::Event> RobotFeed::takeEvents() { return std::exchange(new_events_, {}); }

}  // namespace rc10::web
