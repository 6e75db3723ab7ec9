#include "daemon/clients/scan_desk.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "daemon/exchange/clock.hpp"
#include "survey/harmless_queries.hpp"
#include "survey/link_sighting.hpp"
#include "survey/scan_advice.hpp"

namespace rc10 {
namespace {

// A bus with more ids is no bus of motors.
constexpr std::size_t kMostSightings = 256;
// Clients that read nothing keep no more than these: the oldest is answered without the rest.
constexpr std::size_t kMostDeliveries = 4;

[[nodiscard]] std::vector<survey::KnownMotor> motorsOn(const RobotDescription& robot, std::size_t bus) {
  std::vector<survey::KnownMotor> motors;
  for (const auto& motor : robot.motors) {
    if (motor.bus == bus) motors.push_back({motor.name, motor.family, motor.id, motor.sends, motor.steers});
  }
  return motors;
}

// "VESC id 7 (wheel)", each drive once; ambiguous ones, if they are a motor's.
[[nodiscard]] std::vector<std::string> drivesIn(const std::vector<link::Sighting>& sightings) {
  std::vector<std::string> drives;
  for (const auto& sighting : sightings) {
    for (const auto& guess : std::span{sighting.guesses}.first(sighting.guess_count)) {
      const auto motor = guess.motor.view();
      if (guess.from_drive == 0 || (sighting.ambiguous != 0 && motor.empty())) continue;
      auto drive =
          fmt::format("{} ({}{})", survey::nameOf(guess), guess.collides != 0 ? "collides with " : "",
                      motor.empty() ? "not in the file" : motor);
      if (std::find(drives.begin(), drives.end(), drive) == drives.end()) drives.push_back(std::move(drive));
    }
  }
  return drives;
}

}  // namespace

bool ScanDesk::begin(const Order& order, const link::Request& request) {
  if (running_) return false;
  // Frames that the last scan heard after this thread had looked for the last time.
  (void)exchange_.heard.consume_all([](const CanFrame&) {});
  running_.emplace(Running{.order_id = order.id,
                           .request = request,
                           .bus = order.scan.bus,
                           .begun = monotonicNow(),
                           .dropped_before = exchange_.dropped.load(std::memory_order_relaxed),
                           .listen_only = order.scan.listen_only,
                           .claims = survey::DriveClaims{motorsOn(robot_, order.scan.bus)}});
  return true;
}

void ScanDesk::abandon(std::uint64_t order_id) {
  if (running_ && running_->order_id == order_id) running_.reset();
}

void ScanDesk::takeHeard(Running& scan) {
  CanFrame frame;
  // Only what is there now: a flooded bus must not hold this thread.
  for (auto n = exchange_.heard.read_available(); n > 0 && exchange_.heard.pop(frame); --n) {
    scan.survey.take(frame);
    scan.claims.take(frame);
  }
}

void ScanDesk::turn() {
  if (!running_) return;
  auto& scan = *running_;
  const bool listened = exchange_.listened.load(std::memory_order_acquire) == scan.order_id;
  takeHeard(scan);
  if (listened && !scan.asked) ask(scan);
}

// Those that would be a command to a drive that was heard, or to one of the file, are left out.
void ScanDesk::ask(Running& scan) {
  exchange_.question_count = 0;
  for (const auto& question : survey::harmlessQueries()) {
    auto drive = scan.survey.commandedBy(question);
    if (drive.empty()) drive = scan.claims.commandedBy(question);
    if (!drive.empty()) {
      scan.spared.insert(std::move(drive));
    } else if (exchange_.question_count < exchange_.questions.size()) {
      exchange_.questions.at(exchange_.question_count++) = question;
    }
  }
  scan.asked = true;
  exchange_.ready.store(scan.order_id, std::memory_order_release);
}

std::optional<ScanDesk::Report> ScanDesk::end(const OrderResult& result) {
  if (!running_ || running_->order_id != result.id) return std::nullopt;
  const bool whole = !result.refused && result.scan == Refusal::kNone &&
                     std::all_of(result.motors.begin(), result.motors.end(),
                                 [](Refusal refusal) { return refusal == Refusal::kNone; });
  if (!whole) {
    running_.reset();
    return std::nullopt;
  }
  auto& scan = *running_;
  takeHeard(scan);
  const auto all = scan.survey.sightings(monotonicNow() - scan.begun);
  Report report;
  for (const auto& sighting : all) {
    if (report.sightings.size() == kMostSightings) break;
    auto told = survey::linkSighting(sighting, survey::adviceFor(sighting, all), &scan.claims);
    told.client = scan.request.client;
    told.session = scan.request.session;
    told.seq = scan.request.seq;
    report.sightings.push_back(told);
  }
  report.message = message(scan, result, all, report.sightings);
  running_.reset();
  return report;
}

std::string ScanDesk::message(const Running& scan, const OrderResult& result,
                              const std::vector<survey::Sighting>& all,
                              const std::vector<link::Sighting>& told) const {
  const auto drives = drivesIn(told);
  auto text = fmt::format("scan: {}: {}", robot_.buses[scan.bus].name,
                          drives.empty() ? "no drive was heard" : fmt::format("{}", fmt::join(drives, ", ")));
  if (const auto missing = scan.claims.unheard(); !missing.empty())
    text += fmt::format("\nnot heard, but in the file: {}", fmt::join(missing, ", "));
  if (result.error_frames > 0)
    text += fmt::format(
        "\n{} error frames meanwhile: a drive with another bit rate, the wiring or the termination: `rc10ctl "
        "doctor`",
        result.error_frames);
  if (const auto dropped = exchange_.dropped.load(std::memory_order_relaxed) - scan.dropped_before;
      dropped > 0)
    text += fmt::format("\n{} frames found no room and are not counted", dropped);
  if (told.size() < all.size()) text += fmt::format("\n{} more ids are left out", all.size() - told.size());
  const survey::Asking asking{.listen_only = scan.listen_only, .spared = scan.spared};
  for (const auto& advice : survey::adviceForBus(all, asking)) text += "\n" + advice;
  return text;
}

void ScanDesk::deliver(std::uint64_t connection, const link::Response& response,
                       std::vector<link::Sighting> sightings) {
  if (deliveries_.size() >= kMostDeliveries) deliveries_.front().left.clear();
  deliveries_.push_back({connection, response, {sightings.begin(), sightings.end()}});
}

void ScanDesk::sendOn(Connections& connections) {
  for (auto& delivery : deliveries_) {
    auto* connection = connections.find(delivery.connection);
    auto& left = delivery.left;
    if (connection == nullptr || connection->is_gateway) left.clear();  // rc10-lcm passes answers on, no more
    while (connection != nullptr && !left.empty() && Connections::send(*connection, link::seal(left.front())))
      left.pop_front();
    if (left.empty() && connection != nullptr) Connections::respond(*connection, delivery.response);
  }
  std::erase_if(deliveries_, [](const Delivery& delivery) { return delivery.left.empty(); });
}

}  // namespace rc10
