// Rules for scans of a bus.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "daemon/exchange/bus_scan_exchange.hpp"
#include "daemon/supervision/states.hpp"
#include "faults/oracle.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

// After the last question, and for the link thread to judge what was heard (docs/rc10ctl.md has the rest).
constexpr Duration kAnswering = 200ms;
constexpr Duration kJudging = 2s;
// Ticks that are missed ask nothing.
constexpr Duration kScanSlack = 2s;

[[nodiscard]] bool whole(const OrderResult& result) {
  return !result.refused && result.scan == Refusal::kNone &&
         std::all_of(result.motors.begin(), result.motors.end(),
                     [](Refusal refusal) { return refusal == Refusal::kNone; });
}

}  // namespace

// Neither enabled nor faulty, and its drive is told nothing but rest.
bool Oracle::scanRests(std::size_t index, const Snapshot& snapshot) const {
  const auto status = snapshot.motors[index].status;
  return !isOn(status) && status != MotorStatus::kFault;
}

// It was accepted: every motor of its bus stands still, or has had its time to run down.
void Oracle::beginScan(const Order& order, const Snapshot& snapshot) {
  if (scan_) fail("a scan begins beside another one");
  ++visits_.scans;
  scan_ = Scan{.id = order.id, .order = order.scan, .since = now_};
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (motors_[i].bus != order.scan.bus) continue;
    const auto& measured = motors_[i].wire->measured();
    const auto most_rpm = static_cast<double>(motors_[i].config->standstill_rpm);
    require(i,
            overdue(motors_[i]) || std::fabs(measured.velocity_rpm) <= most_rpm + measured.velocity_step_rpm,
            "its bus is scanned while it turns");
    require(i, !overdue(motors_[i]) || !mayTurn(i, snapshot.motors[i].feedback),
            "its bus is scanned while it may still turn");
  }
}

void Oracle::judgeEnd(const OrderResult& result) {
  const bool made = whole(result);
  const bool listened = now_ - scan_->since >= scan_->order.listen;
  if (made && !listened) fail("a scan ends before it has listened");
  if (made && scan_->order.listen_only && result.asked > 0) fail("a scan asks although it is to listen only");
  if (scan_->all_read && result.asked != scan_->questions)
    fail(fmt::format("a scan tells {} questions, and {} were sent", result.asked, scan_->questions));
  if (made) ++visits_.scanned;
  scan_.reset();
}

// One in a tick, at its pace, after it has listened, and none in the tick in which it ends.
void Oracle::judgeQuestions(const Snapshot& snapshot, std::bitset<kMaxBuses> read) {
  std::uint32_t count = 0;
  for (const auto& [bus, frame] : questions_) {
    if (!read.test(bus)) continue;  // it may have waited
    ++visits_.questions;
    if (!scan_ || scan_->order.bus != bus) fail(fmt::format("a question of no scan: {}", describe(frame.id)));
    if (++count > 1) fail("two questions of a scan in one tick");
    if (scan_->order.listen_only) fail("a scan asks although it is to listen only");
    if (now_ - scan_->since < scan_->order.listen) fail("a scan asks before it has listened");
    if (scan_->questions > 0 && now_ - scan_->last_question < scan_->order.between)
      fail("a scan asks faster than its pace");
    if (held_.test(bus)) fail("a scan asks on a bus that carries no frames");
    if (stop_asked_) fail("a scan asks while rc10d stops");
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (motors_[i].bus != bus) continue;
      require(i, scanRests(i, snapshot), "its bus is asked although it does not rest");
      require(i, !motors_[i].strangers_wire->changedBy(frame), "a question of a scan changes its drive");
    }
    ++scan_->questions;
    scan_->last_question = now_;
  }
  if (scan_ && !read.test(scan_->order.bus)) scan_->all_read = false;
  questions_.clear();
}

void Oracle::judgeScans(const Snapshot& snapshot, std::bitset<kMaxBuses> read) {
  for (const auto& order : scans_asked_) {
    const auto result = std::find_if(scan_results_.begin(), scan_results_.end(),
                                     [&](const auto& each) { return each.id == order.id; });
    const bool refused = result != scan_results_.end() && result->refused;
    if (refused) ++visits_.scans_refused;
    if (!refused) beginScan(order, snapshot);
  }
  scans_asked_.clear();
  const auto asked_before = scan_ ? scan_->questions : 0;
  judgeQuestions(snapshot, read);
  for (const auto& result : scan_results_) {
    if (!scan_ || result.id != scan_->id) continue;
    if (scan_->questions != asked_before) fail("a scan asks in the tick in which it ends");
    judgeEnd(result);
  }
  scan_results_.clear();
  if (!scan_) return;
  const auto& order = scan_->order;
  if (left_scan_ == scan_->id) fail("a scan goes on although its client has left");
  if (stop_asked_) fail("a scan goes on while rc10d stops");
  if (held_.test(order.bus)) fail("a scan goes on although its bus carries no frames");
  for (std::size_t i = 0; i < motors_.size(); ++i)
    require(i, motors_[i].bus != order.bus || scanRests(i, snapshot),
            "its bus is scanned although it does not rest");
  const auto pace = std::max<Duration>(order.between, config_.period());
  const Duration longest = order.listen + kJudging +
                           pace * static_cast<std::int64_t>(BusScanExchange::kMostQuestions) + kAnswering +
                           kScanSlack;
  if (now_ - scan_->since > longest) fail("a scan does not end");
}

}  // namespace rc10::test
