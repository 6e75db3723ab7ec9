#include "daemon/clients/request_desk.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "app/nearest.hpp"
#include "daemon/clients/disable_at_end.hpp"
#include "daemon/clients/drive_request.hpp"
#include "daemon/clients/gain_request.hpp"
#include "daemon/clients/scan_request.hpp"
#include "daemon/clients/shaft_request.hpp"
#include "daemon/clients/validity.hpp"
#include "link/at_end.hpp"

namespace rc10 {
namespace {

// As far as soft limits go (angle_min_deg).
constexpr double kFarthestZeroDeg = 1e6;

// Each gain is an event: those of one tick must leave room for others in their ring.
constexpr std::ptrdiff_t kMaxOpenGains = 8;
constexpr std::string_view kAngle = "angle_deg";

[[nodiscard]] bool comesOfItself(const link::Request& request) {
  const auto values = std::span(request.values).first(request.value_count);
  return std::any_of(values.begin(), values.end(), [](const auto& value) {
    return value.name.view() == link::kAtEnd && value.value != 0.0;
  });
}

// "enable, disable, … and load".
[[nodiscard]] std::string operationsInWords() {
  const auto last = kOperationWords.end() - 1;
  return fmt::format("{} and {}", fmt::join(kOperationWords.begin(), last, ", "), *last);
}

[[nodiscard]] std::string travelText(const Travel& travel) {
  if (!std::isfinite(travel.min_deg)) return fmt::format("up to {:.6g} deg", travel.max_deg);
  if (!std::isfinite(travel.max_deg)) return fmt::format("from {:.6g} deg", travel.min_deg);
  return fmt::format("{:.6g} to {:.6g} deg", travel.min_deg, travel.max_deg);
}

[[nodiscard]] std::string inWords(Refusal refusal, const RobotDescription::Motor& motor) {
  switch (refusal) {
    case Refusal::kNone: return "done";
    case Refusal::kOffline: return "offline: no feedback from the drive; check power, wiring and id";
    case Refusal::kFaulted: return "in FAULT: clear it first";
    case Refusal::kEstop: return "the robot is in ESTOP: clear it first";
    case Refusal::kStopping: return "rc10d is stopping";
    case Refusal::kActive: return "ACTIVE: disable it first";
    case Refusal::kNoPosition: return "no position: the drive sends no feedback";
    case Refusal::kDriveRefused: return "the drive did not confirm in time";
    case Refusal::kGroup: return "another motor of its group is offline, in fault or not enabled";
    case Refusal::kTogether: return "its group is enabled all or none: name all of its motors";
    case Refusal::kDisabled: return "disabled while it was being enabled";
    case Refusal::kMoving: return "still turning: the e-stop is cleared when every motor stands still";
    case Refusal::kEstopInput:
      return "the e-stop input is open: release the button, or mend its wire or chip; with an enabling "
             "switch hold it in the middle";
    case Refusal::kMayTurn:
      return fmt::format(
          "no feedback, and it may still turn: wait until {:.6g} s (run_down_s) after its last feedback",
          std::chrono::duration<double>(motor.run_down).count());
    case Refusal::kEstopAsked: return "an e-stop was asked for at the same time: it stays; clear it again";
    case Refusal::kConfiguring: return "a drive is being configured: wait for it";
    case Refusal::kNotConfirmed:
      return "the drive did not tell the setting as it was written; nothing after it was written or stored";
    case Refusal::kNotSaved:
      return "written, but the drive did not tell that it stored it: it is lost when the power is off";
    case Refusal::kNoGains: return "its drive closes its loops, with its own gains";
    case Refusal::kStillActs: return "still being damped, braked or held: disable it once more to let go";
    case Refusal::kRestFirst:
      return "held, damped or braked, and its drive has to rest before it is enabled: disable it once more, "
             "which lets go, then enable it";
    case Refusal::kAlone: return "locked while another motor is enabled alone";
    case Refusal::kOthersOn: return "not the only one: disable all others first";
    case Refusal::kTurnUnclear:
      return fmt::format(
          "its turn is unclear: turn it by hand into its travel ({}); with a travel of a turn or more set "
          "its angle, rc10ctl zero",
          travelText(motor.travel));
    case Refusal::kOutOfReach:
      return fmt::format(
          "with this zero part of its travel ({}) would lie beyond the positions that its drive can be told: "
          "turn it back towards the drive's own 0, near which most drives are when they are switched on (at "
          "the end of its scale there is no zero at all); or the drive has not told its count of turns yet: "
          "try again",
          travelText(motor.travel));
    case Refusal::kScanning:
    case Refusal::kBusHeld:
    case Refusal::kTooBusy:
    case Refusal::kClientGone: break;  // in whyNoScan()
  }
  return "unknown reason";
}

[[nodiscard]] std::string tooLate(Duration waited) {
  return fmt::format(
      "the request is {} ms old, since rc10d stood still or was not reached: it was not done; ask again",
      waited / std::chrono::milliseconds{1});
}

[[nodiscard]] Right rightFor(Operation operation) {
  switch (operation) {
    case Operation::kClear: return Right::kClear;
    case Operation::kSetGains: return Right::kTune;
    case Operation::kConfigure:
    case Operation::kScan: return Right::kConfigure;
    case Operation::kEnable:
    case Operation::kEnableAlone:
    case Operation::kDisable:
    case Operation::kEstop:
    case Operation::kZero:
    case Operation::kGetConfig:
    case Operation::kDriveSettings:
    case Operation::kHand:
    case Operation::kLoad: break;
  }
  return Right::kCommand;
}

}  // namespace

RequestDesk::RequestDesk(const Admission& admission, const RobotDescription& robot)
    : admission_(admission), robot_(robot) {
  loops_.reserve(robot.motors.size());
  for (const auto& motor : robot.motors) loops_.push_back(motor.loops);
}

link::Response RequestDesk::respond(const link::Request& request, link::ResponseStatus status,
                                    const std::string& message) {
  link::Response response;
  response.client = request.client;
  response.session = request.session;
  response.seq = request.seq;
  response.status = status;
  response.message = message;
  return response;
}

RequestDesk::Outcome RequestDesk::begin(const link::Request& request, const Speaker& speaker,
                                        MonotonicTime now) {
  const auto operation = operationNamed(request.operation.view());
  Outcome outcome;
  // An e-stop is an e-stop, whatever else the message says, and however often it comes.
  outcome.estop = operation == Operation::kEstop;
  const auto asker = speaker.owner();
  const auto* known = answered_.find(asker, request);
  auto* open = openRepetition(asker, request);
  // An answer from memory stops nothing.
  const bool anew = operation && stops(*operation);
  if (known != nullptr && !anew) {
    outcome.response = *known;
    return outcome;
  }
  if (open != nullptr && !anew) {
    open->connection = speaker.connection;  // a repetition: answered when the first is
    return outcome;
  }
  if (const auto waited = waitedSince(request.received_ns, now); waited > kMaxRequestAge && !anew) {
    outcome.response = respond(request, link::ResponseStatus::kRefused, tooLate(waited));
    // Its repetitions are the same request: none acts after this answer.
    answered_.remember(asker, request, *outcome.response);
    return outcome;
  }
  if (operation == Operation::kDriveSettings) return tellSettings(request);
  if (operation == Operation::kGetConfig) return tellConfig(request);
  if (operation == Operation::kHand || operation == Operation::kLoad)
    return actOnShaft(*operation, request, speaker);
  auto order =
      operation ? orderOf(request, *operation) : Result<Order>{tl::unexpected(unknownOperation(request))};
  const auto at_end = operation ? DisableAtEnd::askedBy(request, *operation, speaker) : Result<bool>{false};
  if (order && !at_end) order = tl::unexpected(at_end.error());
  const auto tries =
      operation == Operation::kSetGains ? GainsAtEnd::askedBy(request, speaker) : Result<bool>{false};
  if (order && !tries) order = tl::unexpected(tries.error());
  if (!operation || !order) {
    outcome.response = respond(request, link::ResponseStatus::kRefused, order.error().message);
    answered_.remember(asker, request, *outcome.response);
    return outcome;
  }
  if (!outcome.estop) {
    // A bus without motors is the whole robot's.
    const auto everybody = MotorSet{}.set() >> (kMaxMotors - robot_.motors.size());
    outcome.not_permitted = admission_.permissions().whyNoRequest(
        speaker, request.client.view(), rightFor(*operation), order->motors.any() ? order->motors : everybody,
        order->whole_robot);
  }
  if (!outcome.not_permitted.empty()) {
    // Not remembered: another rule may be in force when it is repeated.
    outcome.response = respond(request, link::ResponseStatus::kRefused, outcome.not_permitted);
    return outcome;
  }
  order->id = next_order_id_++;
  const bool again = known != nullptr || open != nullptr;
  order->asked = comesOfItself(request) ? Asked::kUnasked : again ? Asked::kAgain : Asked::kAnew;
  open_.push_back({speaker.connection, asker, request, *order, *tries});
  outcome.order = *order;
  outcome.disable_at_end = *at_end;
  return outcome;
}

Error RequestDesk::unknownOperation(const link::Request& request) {
  const auto word = request.operation.view();
  return Error{fmt::format("unknown operation '{}': there are {}{}", word, operationsInWords(),
                           didYouMean(word, {kOperationWords.begin(), kOperationWords.end()}))};
}

Result<Order> RequestDesk::orderOf(const link::Request& request, Operation operation) const {
  Order order{.operation = operation,
              .motors = {},
              .client = request.client,
              .whole_robot = request.target.view().empty()};
  const auto refuse = [](std::string why) { return tl::unexpected(Error{std::move(why)}); };
  std::optional<std::string_view> unknown_value;
  for (std::size_t i = 0; i < request.value_count; ++i) {
    if (request.values[i].name.view() == kAngle) {
      order.value = request.values[i].value;
    } else {
      unknown_value = request.values[i].name.view();
    }
  }
  const bool zeroes = operation == Operation::kZero;
  if (zeroes && order.whole_robot) return refuse("zero needs a motor: name it");
  // Without its value the angle would be 0, silently.
  if (zeroes && unknown_value)
    return refuse(fmt::format("zero: there is no value '{}': it takes angle_deg{}", *unknown_value,
                              didYouMean(*unknown_value, {kAngle})));
  if (!std::isfinite(order.value)) return refuse("angle_deg is not a finite number");
  if (zeroes && std::fabs(order.value) > kFarthestZeroDeg)
    return refuse(fmt::format("angle_deg: {} is out of range; use -1000000 to 1000000", order.value));
  if (!mayOpen(request.client.view())) return refuse("too many requests at once: wait for the answers");
  if (operation == Operation::kScan) {
    const auto scan = parseScan(request, robot_);
    if (!scan) return tl::unexpected(scan.error());
    order.scan = *scan;
    order.motors = rc10::motorsOf(robot_, scan->bus);
    order.whole_robot = false;
    return order;
  }
  const auto motors = motorsOf(request);
  if (!motors) return tl::unexpected(motors.error());
  order.motors = *motors;
  if (operation == Operation::kEnableAlone) {
    if (const auto motor = theMotor(request); !motor) return tl::unexpected(motor.error());
  }
  if (operation == Operation::kConfigure) {
    const auto drive = driveWriteOf(request);
    if (!drive) return tl::unexpected(drive.error());
    order.drive = *drive;
  }
  if (operation == Operation::kSetGains) {
    const auto gains = changesOf(request);
    if (!gains) return tl::unexpected(gains.error());
    order.gains = *gains;
  }
  return order;
}

// At most as many as are left for the others: a client that floods leaves room for a newcomer.
bool RequestDesk::mayOpen(std::string_view client) const {
  const auto own = std::count_if(open_.begin(), open_.end(),
                                 [client](const Open& open) { return open.request.client.view() == client; });
  return static_cast<std::size_t>(own) + open_.size() < kMaxOpenRequests;
}

std::string RequestDesk::theMotorsAre(std::string_view typed) const {
  std::vector<std::string_view> names;
  names.reserve(robot_.motors.size());
  for (const auto& motor : robot_.motors) names.emplace_back(motor.name);
  return fmt::format("the motors are: {}{}", fmt::join(names, ", "), didYouMean(typed, names));
}

Result<MotorSet> RequestDesk::motorsOf(const link::Request& request) const {
  MotorSet motors;
  std::string_view rest = request.target.view();
  if (rest.empty()) {
    for (std::size_t i = 0; i < robot_.motors.size(); ++i) motors.set(i);
  }
  while (!rest.empty()) {
    const auto comma = rest.find(',');
    const auto name = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
    const int index = admission_.indexOf(name);
    if (index < 0) {
      return tl::unexpected(Error{fmt::format("there is no motor '{}'; {}", name, theMotorsAre(name))});
    }
    motors.set(static_cast<std::size_t>(index));
  }
  return motors;
}

const DriveSetup& RequestDesk::setupOf(std::size_t motor) const {
  static constexpr DriveSetup kNone{};
  const auto* setup = robot_.motors[motor].setup;
  return setup != nullptr ? *setup : kNone;
}

Result<std::size_t> RequestDesk::theMotor(const link::Request& request) const {
  const auto name = request.target.view();
  const int index = admission_.indexOf(name);
  if (index >= 0) return static_cast<std::size_t>(index);
  return tl::unexpected(Error{fmt::format("name one motor, not '{}'; {}", name, theMotorsAre(name))});
}

RequestDesk::Outcome RequestDesk::tellSettings(const link::Request& request) const {
  Outcome outcome;
  const auto motor = theMotor(request);
  outcome.response = motor ? respond(request, link::ResponseStatus::kOk, settingsText(setupOf(*motor)))
                           : respond(request, link::ResponseStatus::kRefused, motor.error().message);
  return outcome;
}

Result<DriveWrite> RequestDesk::driveWriteOf(const link::Request& request) const {
  const auto motor = theMotor(request);
  if (!motor) return tl::unexpected(motor.error());
  return parseDriveWrite(request, setupOf(*motor));
}

std::string RequestDesk::driveOutcome(const Open& open, const OrderResult& result) const {
  const auto motor = theMotor(open.request).value_or(0);
  const auto& setup = setupOf(motor);
  switch (result.motors[motor]) {
    case Refusal::kNone: return fmt::format("{}: {}", nameOf(motor), wordsOf(open.order.drive, setup));
    case Refusal::kNotConfirmed:
      return fmt::format("{}: {}: {}", nameOf(motor), settingAt(open.order.drive, setup, result.drive_value),
                         inWords(Refusal::kNotConfirmed, robot_.motors[motor]));
    case Refusal::kOthersOn:
      return fmt::format(
          "{}: of its group, {} is on or held, and has to rest meanwhile: `rc10ctl disable {}` first, once "
          "more to let go of what is held",
          nameOf(motor), namesOf(result.in_the_way, " and "), namesOf(result.in_the_way, " "));
    default: return fmt::format("{}: {}", nameOf(motor), inWords(result.motors[motor], robot_.motors[motor]));
  }
}

Result<std::size_t> RequestDesk::motorWithGains(const link::Request& request) const {
  auto motor = theMotor(request);
  if (!motor) return motor;
  if (auto has = checkHasGains(nameOf(*motor), loops_[*motor]); !has) return tl::unexpected(has.error());
  return motor;
}

RequestDesk::Outcome RequestDesk::tellConfig(const link::Request& request) const {
  Outcome outcome;
  const auto motor = motorWithGains(request);
  if (motor) {
    outcome.response = respond(request, link::ResponseStatus::kOk, gainLines(loops_[*motor]));
    tellGains(loops_[*motor], *outcome.response);
  } else {
    outcome.response = respond(request, link::ResponseStatus::kRefused, motor.error().message);
  }
  return outcome;
}

Result<GainChanges> RequestDesk::changesOf(const link::Request& request) const {
  const auto open =
      std::count_if(open_.begin(), open_.end(), [](const Open& each) { return each.order.gains.count > 0; });
  if (open >= kMaxOpenGains)
    return tl::unexpected(Error{"too many changes of gains at once: wait for the answers"});
  const auto motor = motorWithGains(request);
  if (!motor) return tl::unexpected(motor.error());
  const auto changes = parseGains(request, loops_[*motor]);
  if (!changes) return tl::unexpected(Error{nameOf(*motor) + ": " + changes.error().message});
  return *changes;
}

RequestDesk::Outcome RequestDesk::actOnShaft(Operation operation, const link::Request& request,
                                             const Speaker& speaker) const {
  Outcome outcome;
  const auto refuse = [&](const std::string& why) {
    outcome.response = respond(request, link::ResponseStatus::kRefused, why);
    return outcome;
  };
  const auto motor = theMotor(request);
  if (!motor) return refuse(motor.error().message);
  outcome.not_permitted = admission_.permissions().whyNoRequest(
      speaker, request.client.view(), Right::kCommand, MotorSet{}.set(*motor), false);
  if (!outcome.not_permitted.empty()) return refuse(outcome.not_permitted);
  const auto& drive = robot_.motors[*motor].simulated;
  const auto order = operation == Operation::kHand ? parseHand(request, nameOf(*motor), drive)
                                                   : parseLoad(request, nameOf(*motor), drive);
  if (!order) return refuse(order.error().message);
  outcome.shaft =
      Shaft{*order, respond(request, link::ResponseStatus::kOk, shaftInWords(*order, nameOf(*motor)))};
  return outcome;
}

// A repeated request is answered from here: it does not turn the joint twice.
void RequestDesk::shaftTaken(const link::Request& request, const Speaker& speaker,
                             const link::Response& response) {
  answered_.remember(speaker.owner(), request, response);
}

// Orders are carried out in the order in which they were given, and so what is done to loops_ here is what
// was done to the motor's.
void RequestDesk::finishGains(const Open& open, const OrderResult& result, Answer& answer) {
  auto& response = answer.response;
  const auto motor = theMotor(open.request).value_or(0);
  const auto changes = std::span(open.order.gains.values).first(open.order.gains.count);
  if (result.motors[motor] != Refusal::kNone) {
    response.message =
        fmt::format("{}: {}", nameOf(motor), inWords(result.motors[motor], robot_.motors[motor]));
    if (open.connection != kNobody) return;
    bool last = false;
    for (const auto& change : changes) last = gains_at_end_.refused(motor, change.gain) || last;
    if (last) answer.note = leftGainsOf({motor, open.request.client, open.order.gains});
    return;
  }
  for (const auto& change : changes) {
    const GainChange before{change.gain, gainOf(loops_[motor].config, change.gain)};
    if (open.tries_gains)
      gains_at_end_.tried(open.connection, open.request.client, motor, before);
    else
      gains_at_end_.settled(motor, change.gain);
  }
  response.message =
      fmt::format("{}: {}; until {}", nameOf(motor), applyGains(open.order.gains, loops_[motor]),
                  open.tries_gains ? "its client ends" : "rc10d restarts");
  tellGains(loops_[motor], response);
}

// rc10d alone knows it: the angle may have been set before, by anybody.
void RequestDesk::tellZero(double zero_deg, link::Response& response) {
  if (!std::isfinite(zero_deg)) return;  // nothing that a file could keep
  const double rounded_deg = std::round(zero_deg * 100.0) / 100.0;
  response.message =
      fmt::format("{}; zero_deg: {} in the file keeps it", response.message.view(), rounded_deg);
  response.values[response.value_count++] = {.name = std::string_view{"zero_deg"}, .value = rounded_deg};
}

// With the motors that are in the way by their names, and the numbers of this one.
std::string RequestDesk::namesOf(const MotorSet& motors, std::string_view between) const {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < robot_.motors.size(); ++i) {
    if (motors.test(i)) names.emplace_back(nameOf(i));
  }
  return fmt::format("{}", fmt::join(names, between));
}

std::string RequestDesk::reasonOf(Refusal reason, std::size_t motor, const MotorSet& in_the_way) const {
  const std::string them = namesOf(in_the_way, " ");
  switch (reason) {
    case Refusal::kAlone:
      return fmt::format("locked while {} is enabled alone: `rc10ctl disable {}` ends that", them, them);
    case Refusal::kOthersOn: return fmt::format("not the only one: `rc10ctl disable {}` first", them);
    case Refusal::kTogether: return fmt::format("its group is enabled all or none: name {} as well", them);
    case Refusal::kGroup:
      return them.empty() ? inWords(reason, robot_.motors[motor])
                          : fmt::format("of its group, {} cannot be enabled: offline or in fault", them);
    default: return inWords(reason, robot_.motors[motor]);
  }
}

// "left, right: offline; arm: in FAULT": each reason once.
std::string RequestDesk::reasons(const MotorSet& motors, const OrderResult& result) const {
  std::vector<std::pair<std::string, std::string>> found;  // a reason, and who has it
  for (std::size_t i = 0; i < robot_.motors.size(); ++i) {
    if (!motors.test(i) || result.motors[i] == Refusal::kNone) continue;
    auto reason = reasonOf(result.motors[i], i, result.in_the_way);
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&reason](const auto& each) { return each.first == reason; });
    if (same != found.end())
      same->second += ", " + nameOf(i);
    else
      found.emplace_back(std::move(reason), nameOf(i));
  }
  std::string text;
  for (const auto& [reason, who] : found)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", who, reason);
  return text;
}

std::optional<RequestDesk::Answer> RequestDesk::finish(const OrderResult& result, const std::string& report) {
  const auto found =
      std::find_if(open_.begin(), open_.end(), [&](const Open& open) { return open.order.id == result.id; });
  if (found == open_.end()) return std::nullopt;
  const auto operation = found->order.operation;
  std::size_t failed = 0;
  std::size_t needed_failed = 0;  // without those that may fail
  for (std::size_t i = 0; i < robot_.motors.size(); ++i) {
    if (!found->order.motors.test(i) || result.motors[i] == Refusal::kNone) continue;
    ++failed;
    if (operation != Operation::kEnable || !robot_.motors[i].optional) ++needed_failed;
  }
  const auto total = found->order.motors.count();
  auto status = link::ResponseStatus::kOk;
  std::string message =
      fmt::format("{}: {} of {} motors", found->request.operation.view(), total - failed, total);
  const bool stays = std::any_of(result.motors.begin(), result.motors.end(), [](Refusal refusal) {
    return refusal == Refusal::kMoving || refusal == Refusal::kMayTurn;
  });
  if (stays) message = fmt::format("{}: nothing done", found->request.operation.view());
  const bool nothing_done = failed != 0 && failed == total;
  if (needed_failed != 0 || nothing_done) status = link::ResponseStatus::kFailed;
  if (failed != 0) message += " (" + reasons(found->order.motors, result) + ")";
  if (result.estop_stays) message += "; the e-stop stays: `clear` without a name ends it";
  if (operation == Operation::kConfigure) message = driveOutcome(*found, result);
  if (operation == Operation::kScan) {
    message = whyNoScan(found->order, result, robot_);
    status = message.empty() ? link::ResponseStatus::kOk : link::ResponseStatus::kFailed;
    if (message.empty()) message = report;
    if (result.refused) status = link::ResponseStatus::kRefused;
  } else if (result.refused) {
    status = link::ResponseStatus::kRefused;
    message = "too many enable requests at once: wait for the answers";
  }
  Answer answer{found->connection, respond(found->request, status, message), {}};
  if (operation == Operation::kSetGains) finishGains(*found, result, answer);
  if (operation == Operation::kZero && failed == 0) tellZero(result.zero_deg, answer.response);
  if (found->connection != kNobody) answered_.remember(found->asker, found->request, answer.response);
  open_.erase(found);
  return answer;
}

std::optional<RequestDesk::Answer> RequestDesk::fail(std::uint64_t order_id, const std::string& reason) {
  const auto found =
      std::find_if(open_.begin(), open_.end(), [&](const Open& open) { return open.order.id == order_id; });
  if (found == open_.end()) return std::nullopt;
  // Not remembered: the same request may succeed when it is repeated.
  Answer answer{found->connection, respond(found->request, link::ResponseStatus::kFailed, reason), {}};
  open_.erase(found);
  return answer;
}

std::optional<std::uint64_t> RequestDesk::scanForNobody(const IsOpen& is_open) const {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const Open& open) {
    return open.order.operation == Operation::kScan && !is_open(open.connection);
  });
  return found == open_.end() ? std::nullopt : std::optional{found->order.id};
}

// One at a time: until its result it is due still.
std::optional<Order> RequestDesk::gainsForNobody(const IsOpen& is_open) {
  if (std::any_of(open_.begin(), open_.end(), [](const Open& open) { return open.connection == kNobody; }))
    return std::nullopt;
  const auto due = gains_at_end_.due(is_open);
  if (!due) return std::nullopt;
  Open open;
  open.request.client = due->client;
  open.request.operation = toString(Operation::kSetGains);
  open.request.target = nameOf(due->motor);
  open.order = {.id = next_order_id_++,
                .operation = Operation::kSetGains,
                .motors = MotorSet{}.set(due->motor),
                .gains = due->gains,
                .client = due->client};
  open_.push_back(open);
  return open.order;
}

std::vector<std::string> RequestDesk::gainsLeft() const {
  std::vector<std::string> texts;
  for (const auto& left : gains_at_end_.left()) texts.push_back(leftGainsOf(left));
  return texts;
}

std::string RequestDesk::leftGainsOf(const GainsAtEnd::Due& left) const {
  return leftGains(nameOf(left.motor), left.client.view(), loops_[left.motor], left.gains);
}

RequestDesk::Open* RequestDesk::openRepetition(std::uint64_t asker, const link::Request& request) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const Open& each) {
    return each.connection != kNobody && each.asker == asker && repeats(request, each.request);
  });
  return found == open_.end() ? nullptr : &*found;
}

}  // namespace rc10
