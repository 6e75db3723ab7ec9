#include "web/hub.hpp"

#include <algorithm>
#include <utility>

#include "app/message_limits.hpp"
#include "client/find_motor.hpp"
#include "config/sha256.hpp"
#include "link/run_dir.hpp"
#include "web/checked_config.hpp"
#include "web/page_messages.hpp"
#include "web/running_config.hpp"
#include "web/signal_names.hpp"

namespace rc10::web {
namespace {

constexpr std::uint64_t kTurnsPerSecond = 100;
constexpr std::uint64_t kConnectEvery = kTurnsPerSecond / 2;
// 25 pictures a second: an eye sees no more of a curve.
constexpr std::uint64_t kPublishEvery = kTurnsPerSecond / 25;

// From the moment at which the page sent its renewal.
constexpr Duration kHeldLease = std::chrono::milliseconds{150};
// After a wrong token, for all pages together: opening another one gives no more tries.
constexpr Duration kWrongTokenPause = std::chrono::milliseconds{200};

PageSocket::Text shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

constexpr std::string_view statusWord(link::ResponseStatus status) {
  switch (status) {
    case link::ResponseStatus::kOk: return "ok";
    case link::ResponseStatus::kRefused: return "refused";
    case link::ResponseStatus::kFailed: break;
  }
  return "failed";
}

[[nodiscard]] std::span<const link::NamedValue> valuesOf(const link::Response& response) {
  return std::span{response.values}.first(std::min<std::size_t>(response.value_count, link::kMaxValues));
}

}  // namespace

Hub::Hub(std::optional<std::string> robot, std::string token, Recordings recordings, std::string file_socket)
    : robot_(std::move(robot)),
      feed_(robot_),
      token_(std::move(token)),
      recordings_(std::move(recordings)),
      file_socket_(std::move(file_socket)) {}

Hub::Page* Hub::pageOf(const PageSocket& socket) noexcept {
  const auto found =
      std::find_if(pages_.begin(), pages_.end(), [&](const auto& page) { return page->socket == &socket; });
  return found == pages_.end() ? nullptr : found->get();
}

void Hub::join(PageSocket& socket, bool loopback, std::string_view address) {
  auto page = std::make_unique<Page>();
  page->socket = &socket;
  page->loopback = loopback;
  page->right = rightOf(loopback, {}, token_);
  // As the owner of a motor and in rc10d's log.
  page->number = ++opened_;
  page->name = "web-" + std::to_string(page->number) + " " + std::string{address};
  page->name.resize(std::min(page->name.size(), sizeof(link::Name) - 1));
  page->link = std::make_unique<PageLink>(page->name);
  greet(*page);
  pages_.push_back(std::move(page));
}

void Hub::leave(PageSocket& socket) {
  if (const auto* page = pageOf(socket); page != nullptr) {
    configs_.forget(page->number);
    std::erase_if(shown_tokens_, [&](const auto& shown) { return shown.page == page->number; });
  }
  std::erase_if(pages_, [&](const auto& page) { return page->socket == &socket; });
  chooseTraces();
}

// All that a page needs to draw its first picture.
void Hub::greet(Page& page) {
  page.socket->sendText(shared(helloMessage(page.right, page.name)));
  if (page.right == PageRight::kNothing) return;
  if (!feed_.connected()) {
    page.socket->sendText(shared(downNow()));
    return;
  }
  page.socket->sendText(shared(robotMessage(feed_)));
  for (const auto& event : feed_.pastEvents()) page.socket->sendText(shared(eventMessage(event)));
}

void Hub::handle(PageSocket& socket, std::string_view message, MonotonicTime now) {
  Page* page = pageOf(socket);
  if (page == nullptr) return;
  const auto request = parsePageRequest(message);
  if (!request) {
    page->socket->sendText(shared(responseMessage(numberOf(message), "refused", request.error().message)));
    return;
  }
  if (const auto* shown = std::get_if<ShowToken>(&*request)) {
    take(*page, *shown, now);
  } else if (const auto* robot = std::get_if<AskRobot>(&*request)) {
    ask(*page, *robot, now, robot->sent ? page->renewals.ageOf(*robot->sent, now) : Duration::zero());
  } else if (const auto* held = std::get_if<DriveMotor>(&*request)) {
    drive(*page, *held, now, page->renewals.ageOf(held->sent, now));
  } else if (const auto* clock = std::get_if<TellClock>(&*request)) {
    (void)page->renewals.ageOf(clock->sent, now);
    if (!page->socket->behind()) page->socket->sendText(shared(clockMessage()));
  } else if (const auto* test = std::get_if<StartTest>(&*request)) {
    begin(*page, *test, now, page->renewals.ageOf(test->sent, now));
  } else if (const auto* renewal = std::get_if<RenewTest>(&*request)) {
    const auto age = page->renewals.ageOf(renewal->sent, now);
    if (page->test && page->test->seq() == renewal->seq) page->test->renew(now, age);
  } else if (const auto* end = std::get_if<EndTest>(&*request)) {
    if (page->test && page->test->seq() == end->seq) page->test->end(end->why);
  } else if (const auto* file = std::get_if<ChangeFile>(&*request)) {
    change(*page, *file, page->renewals.ageOf(file->sent, now));
  } else if (page->right == PageRight::kNothing) {
    page->socket->sendText(shared(responseMessage(numberOf(message), "refused", "show the token first")));
  } else if (const auto* view = std::get_if<ChooseView>(&*request)) {
    choose(*page, *view);
  } else if (const auto* range = std::get_if<AskRange>(&*request)) {
    answer(*page, *range);
  } else if (const auto* files = std::get_if<AskRecordings>(&*request)) {
    page->socket->sendText(shared(recordingsMessage(files->seq, recordings_.list())));
  } else if (const auto* recording = std::get_if<AskRecording>(&*request)) {
    open(*page, *recording);
  } else if (const auto* piece = std::get_if<AskPiece>(&*request)) {
    sendPiece(*page, *piece);
  } else if (const auto* words = std::get_if<AskWords>(&*request)) {
    page->socket->sendText(shared(wordsMessage(*words)));
  } else if (const auto* config = std::get_if<AskConfig>(&*request)) {
    showConfigTo(*page, *config);
  } else if (const auto* check_config = std::get_if<CheckConfig>(&*request)) {
    check(*page, *check_config);
  } else if (const auto* curve = std::get_if<AskCurve>(&*request)) {
    sendCurve(*page, *curve);
  }
}

// On this computer it is one of `clients`, for rc10d. From another it is for looking.
void Hub::take(Page& page, ShowToken shown, MonotonicTime now) {
  if (page.loopback) {
    page.link->showToken(std::move(shown.token));
    return greet(page);
  }
  // A longer one is wrong, whatever follows.
  shown.token.resize(std::min(shown.token.size(), token_.size() + 1));
  const auto waiting = std::find_if(shown_tokens_.begin(), shown_tokens_.end(),
                                    [&](const auto& one) { return one.page == page.number; });
  if (waiting != shown_tokens_.end()) {
    // Each has an answer, one that is overtaken too.
    waiting->token = std::move(shown.token);
    return greet(page);
  }
  shown_tokens_.push_back({page.number, std::move(shown.token)});
  judgeTokens(now);
}

void Hub::judgeTokens(MonotonicTime now) {
  while (!shown_tokens_.empty() && now >= next_judgement_) {
    const auto shown = std::move(shown_tokens_.front());
    shown_tokens_.pop_front();
    const auto page = std::find_if(pages_.begin(), pages_.end(),
                                   [&](const auto& one) { return one->number == shown.page; });
    if (page == pages_.end()) continue;
    (*page)->right = rightOf(false, shown.token, token_);
    if ((*page)->right == PageRight::kNothing) next_judgement_ = now + kWrongTokenPause;
    greet(**page);
  }
}

FoundConfig Hub::shownConfig() const {
  if (!feed_.connected()) return readLastConfig(link::runDir(), robot_);
  return readRunningConfig(link::runDir(), std::string{feed_.welcome().robot.view()},
                           std::string{feed_.welcome().config_hash.view()});
}

// A token that has come in the clear shows nothing.
void Hub::showConfigTo(const Page& page, const AskConfig& wanted) {
  const auto found = shownConfig();
  if (found.text.empty())
    return page.socket->sendText(shared(responseMessage(
        wanted.seq, "failed", "rc10d left no copy of its file in the run folder: open the file instead")));
  const auto token = page.loopback ? page.link->token() : std::string{};
  askDesk(page, {.page = page.number,
                 .seq = wanted.seq,
                 .head = configHead(wanted.seq, found.of, sha256(found.text)),
                 .work = shownConfigJson,
                 .input = withToken(token, found.text)});
}

void Hub::check(const Page& page, CheckConfig wanted) {
  askDesk(page, {.page = page.number,
                 .seq = wanted.seq,
                 .head = checkedConfigHead(wanted.seq),
                 .work = checkedConfigJson,
                 .input = std::move(wanted.text)});
}

// The rights are those of the file that rc10d has accepted; polkit decides about rc10-web as a whole.
void Hub::change(Page& page, const ChangeFile& wanted, Duration age) {
  auto refused = whyNotMoving(page);
  if (refused.empty()) refused = whyTooLate(age);
  if (refused.empty() && page.changes_file) refused = "the root helper is at work for this page";
  const auto accepted = readAcceptedConfig(
      link::runDir(), feed_.connected() ? std::optional{std::string{feed_.welcome().robot.view()}} : robot_);
  if (refused.empty() && !accepted)
    refused =
        "rc10d left no copy of its file in the run folder, or several robots did, so nobody knows who may: "
        "start rc10-web with --robot, or install by hand";
  if (!refused.empty() || !accepted)
    return page.socket->sendText(shared(responseMessage(wanted.seq, "refused", refused)));
  page.changes_file = true;
  askDesk(page, {.page = page.number,
                 .seq = wanted.seq,
                 .head = {},
                 .work = mayReplaceJson,
                 .input = withToken(page.link->token(), accepted->text),
                 .then = client::FileRequest{
                     .verb = wanted.verb,
                     .robot = accepted->robot,
                     .replaces = wanted.verb == client::FileVerb::kInstall && wanted.replaces.empty()
                                     ? sha256(shownConfig().text)
                                     : wanted.replaces,
                     .text = wanted.text}});
}

void Hub::askHelper(Page& page, std::int64_t seq, const Result<std::string>& may,
                    const client::FileRequest& request) {
  auto refused = may ? std::string{} : may.error().message;
  if (may && *may != "true") refused = "a page needs the token of an entry of `clients` that may `configure`";
  if (refused.empty()) {
    auto call = client::FileCall::send(request, std::chrono::steady_clock::now(), file_socket_);
    if (call) {
      page.file_seq = seq;
      page.file_call.emplace(std::move(*call));
      return;
    }
    refused = call.error().message;
  }
  page.changes_file = false;
  page.socket->sendText(shared(responseMessage(seq, "refused", refused)));
}

void Hub::publishFileAnswer(Page& page) {
  if (!page.file_call) return;
  const auto answer = page.file_call->poll(std::chrono::steady_clock::now());
  if (!answer) return;
  page.file_call.reset();
  page.changes_file = false;
  page.socket->sendText(
      shared(*answer ? responseMessage(page.file_seq, (*answer)->done ? "ok" : "refused", (*answer)->message)
                     : responseMessage(page.file_seq, "failed", answer->error().message)));
}

// Each question has an answer, one that a newer one overtakes too.
void Hub::askDesk(const Page& page, ConfigDesk::Question question) {
  if (const auto overtaken = configs_.ask(std::move(question)))
    page.socket->sendText(shared(responseMessage(*overtaken, "refused", "a newer text is read instead")));
}

void Hub::answerConfigs() {
  const auto answer = configs_.turn(std::chrono::steady_clock::now());
  if (!answer) return;
  for (const auto& page : pages_) {
    if (page->number != answer->page) continue;
    if (answer->then) {
      askHelper(*page, answer->seq, answer->message, *answer->then);
      continue;
    }
    page->socket->sendText(
        shared(answer->message ? *answer->message
                               : responseMessage(answer->seq, "failed", answer->message.error().message)));
  }
}

void Hub::open(Page& page, const AskRecording& wanted) {
  page.recording.reset();
  page.recording_number = wanted.number;
  auto opened = recordings_.open(wanted.name);
  if (!opened)
    return page.socket->sendText(shared(responseMessage(wanted.number, "failed", opened.error().message)));
  page.recording = std::move(*opened);
  sendPiece(page, AskPiece{wanted.number});
}

// A page asks for each piece when it has the one before: so one that reads slowly holds no memory here.
void Hub::sendPiece(Page& page, const AskPiece& wanted) {
  if (!page.recording || page.recording_number != wanted.number) return;
  bool last = false;
  auto frame = pieceFrame(page.recording->reader, wanted.number, last);
  if (frame)
    page.socket->sendBinary(std::move(*frame));
  else
    page.socket->sendText(shared(responseMessage(wanted.number, "failed", frame.error().message)));
  if (last || !frame) page.recording.reset();
}

void Hub::choose(Page& page, const ChooseView& wanted) {
  page.view_number = wanted.view;
  page.view = View{.signals = {}, .column_us = wanted.column_us};
  std::vector<std::string> drawn;
  std::vector<std::string> unknown;
  const auto infos = feed_.moduleInfos();
  for (const auto& name : wanted.signals) {
    const auto signal =
        feed_.connected() ? traceSignalOf(name, feed_.welcome(), infos) : std::optional<link::TraceSignal>{};
    const bool has_room = signal && hasRoomFor(*signal);
    (has_room ? drawn : unknown).push_back(name);
    if (has_room) page.view->signals.push_back(*signal);
  }
  page.socket->sendText(shared(viewMessage(wanted.view, drawn, unknown, feed_.droppedTicks())));
  const auto& traces = feed_.traces();
  const auto newest = traces.newestUs() / wanted.column_us;
  const auto count = std::clamp<std::int64_t>(wanted.span_us / wanted.column_us, 0, kMaxColumns);
  page.next_column = newest;
  const auto first = std::max(newest - count, traces.oldestUs() / wanted.column_us);
  page.socket->sendBinary(columnsFrame(traces, *page.view, FrameKind::kReset, page.view_number, first,
                                       static_cast<std::size_t>(newest - first)));
  chooseTraces();
}

void Hub::answer(Page& page, const AskRange& wanted) {
  if (!page.view) return;
  const View view{.signals = page.view->signals, .column_us = wanted.column_us};
  page.socket->sendBinary(columnsFrame(feed_.traces(), view, FrameKind::kRange, page.view_number,
                                       wanted.first_column, wanted.count));
}

void Hub::ask(Page& page, const AskRobot& wanted, MonotonicTime now, Duration age) {
  const bool estop = operationNamed(wanted.operation) == Operation::kEstop;
  // Before the page's own connection, which is there for the answer: all may be taken, or rc10d busy.
  const bool under_way = estop && feed_.estop(page.name);
  std::string refused = estop ? std::string{} : whyNotMoving(page);
  if (refused.empty() && wanted.sent) refused = whyTooLate(age);
  if (refused.empty())
    refused = feed_.connected() ? page.link->ask(wanted, feed_.socketPath(), now) : feed_.reason();
  if (refused.empty()) return;
  if (under_way) refused.insert(0, "the e-stop was sent and is not confirmed: ");
  page.socket->sendText(shared(responseMessage(wanted.seq, under_way ? "failed" : "refused", refused)));
}

// A connection that was held up delivers in the end what nobody expects to be done any more.
std::string Hub::whyTooLate(Duration age) {
  if (age <= kMaxRequestAge) return {};
  return "it came " + std::to_string(age / std::chrono::milliseconds{1}) +
         " ms late, the connection was held up, and it was not done: ask again";
}

std::string Hub::whyNotMoving(const Page& page) const {
  switch (page.right) {
    case PageRight::kCommand: return {};
    case PageRight::kNothing: return "show the token first";
    case PageRight::kLook: break;
  }
  return "over a network without encryption a page looks and stops; open it on the robot itself or through a "
         "tunnel: ssh -L 8010:localhost:8010";
}

// Each renewal is a command for the rest of its lease: nothing here repeats one. The end of a hold sends the
// safe target, unless the lease has ended before: it would let go of what the motor's on_timeout holds.
void Hub::drive(Page& page, const DriveMotor& wanted, MonotonicTime now, Duration age) {
  auto refused = whyNotMoving(page);
  if (wanted.held && !page.hold.goesOn(wanted.seq, now) && refused.empty())
    refused =
        "no word of this page for " + std::to_string(HoldGap::kMost.count()) + " ms: let go, and press again";
  if (refused.empty() && !feed_.connected()) refused = feed_.reason();
  if (refused.empty()) {
    if (const auto motor = client::findMotor(feed_.welcome(), wanted.motor); !motor)
      refused = motor.error().message;
  }
  // Connecting may outlast the lease of this renewal; the next one finds the connection open.
  const bool opens = !page.link->isOpen();
  if (refused.empty()) refused = page.link->connect(feed_.socketPath());
  const bool counts = wanted.held ? age < kHeldLease && !opens : page.hold.acts(wanted.seq, now);
  if (refused.empty() && counts) {
    auto told = wanted;
    if (!wanted.held) told.value = 0.0;
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(wanted.held ? kHeldLease - age : kHeldLease);
    refused = page.link->drive(told, static_cast<std::int32_t>(left.count()));
    if (wanted.held) page.hold.sent(now + left);
  }
  if (!refused.empty()) page.socket->sendText(shared(responseMessage(wanted.seq, "refused", refused)));
}

void Hub::begin(Page& page, const StartTest& wanted, MonotonicTime now, Duration age) {
  auto refused = whyNotMoving(page);
  if (refused.empty() && !feed_.connected()) refused = feed_.reason();
  if (refused.empty() && page.test) refused = "a test of this page goes on: stop it first";
  if (refused.empty()) {
    auto test = PageTest::begin(
        wanted, {.client = page.name, .token = page.link->token(), .socket_path = feed_.socketPath()}, now,
        age);
    if (test) {
      page.evaluation.reset();
      page.test = std::move(*test);
    } else {
      refused = test.error().message;
    }
  }
  if (!refused.empty()) page.socket->sendText(shared(responseMessage(wanted.seq, "refused", refused)));
}

// The last piece is the end of it here.
void Hub::sendCurve(Page& page, const AskCurve& wanted) {
  if (!page.evaluation || page.evaluation->seq() != wanted.seq) return;
  page.socket->sendBinary(curveFrame(page.evaluation->curve(), wanted.seq, wanted.first));
  if (wanted.first + kMaxCurveTicks >= page.evaluation->curve().size()) page.evaluation.reset();
}

bool Hub::isTesting() const noexcept {
  return std::any_of(pages_.begin(), pages_.end(), [](const auto& page) { return page->test != nullptr; });
}

void Hub::runTests(MonotonicTime now) {
  for (const auto& page : pages_) {
    if (!page->test) continue;
    page->test->turn(now);
    if (!page->test->isRunning()) {
      page->evaluation = std::make_unique<TestEvaluation>(*page->test, now);
      page->test.reset();
    }
  }
}

void Hub::publishTests(MonotonicTime now) {
  for (const auto& page : pages_) {
    if (page->test) {
      const auto& run = page->test->run();
      const double time_s = run.curve().empty() ? 0.0 : run.curve().back().time_s;
      if (!page->socket->behind())
        page->socket->sendText(shared(testMessage(page->test->seq(), time_s, run.timeS())));
    }
    if (!page->evaluation) continue;
    if (auto message = page->evaluation->message(now)) page->socket->sendText(shared(std::move(*message)));
  }
}

// rc10d gives so many signals to this server, for all pages together.
bool Hub::hasRoomFor(const link::TraceSignal& signal) const {
  const auto all = viewedSignals();
  return all.size() < link::kMaxTraceSignals || std::find(all.begin(), all.end(), signal) != all.end();
}

void Hub::chooseTraces() { feed_.choose(viewedSignals()); }

std::vector<link::TraceSignal> Hub::viewedSignals() const {
  std::vector<link::TraceSignal> all;
  for (const auto& page : pages_) {
    const auto& view = page->view;
    if (!view) continue;
    for (const auto& signal : view->signals) {
      if (std::find(all.begin(), all.end(), signal) == all.end()) all.push_back(signal);
    }
  }
  return all;
}

void Hub::turn() {
  judgeTokens(std::chrono::steady_clock::now());
  watchRobot();
  if (turns_++ % kPublishEvery == 0) publish();
  for (const auto& page : pages_) {
    publishAnswers(*page);
    publishFileAnswer(*page);
  }
  answerConfigs();
}

void Hub::watchRobot() {
  if (!feed_.connected() && turns_ % kConnectEvery == 0) {
    feed_.connect();
    if (!feed_.connected()) tellDown();
  }
  if (feed_.connected() && !feed_.receive()) {
    for (const auto& page : pages_) {
      page->link->close();
      page->view.reset();  // its signals were those of that robot: the page chooses anew
    }
    told_down_.clear();
    tellDown();
  }
  if (feed_.takeRobotIsNew()) tell(robotMessage(feed_));
}

std::string Hub::downNow() const {
  return downMessage(feed_.reason(), readDaemonEnd(link::runDir(), robot_));
}

// Again when more is known of it.
void Hub::tellDown() {
  if (auto now = downNow(); now != told_down_) tell(told_down_ = std::move(now));
}

void Hub::publish() {
  for (const auto& event : feed_.takeEvents()) tell(eventMessage(event));
  if (const auto* diagnostics = feed_.takeDiagnostics()) tell(diagnosticsMessage(feed_, *diagnostics));
  if (const auto* state = feed_.takeState(); state != nullptr && !pages_.empty()) {
    const auto text = shared(stateMessage(feed_, *state));
    for (const auto& page : pages_) {
      if (page->right != PageRight::kNothing && !page->socket->behind()) page->socket->sendText(text);
    }
  }
  for (const auto& page : pages_) publishColumns(*page);
  publishTests(std::chrono::steady_clock::now());
}

void Hub::publishColumns(Page& page) {
  if (!page.view || page.view->signals.empty() || page.socket->behind()) return;
  // The column of the newest row may still grow.
  const auto end = feed_.traces().newestUs() / page.view->column_us;
  if (end <= page.next_column) return;
  const auto oldest = feed_.traces().oldestUs() / page.view->column_us;
  const auto first = std::max({page.next_column, oldest, end - static_cast<std::int64_t>(kMaxColumns)});
  page.socket->sendBinary(columnsFrame(feed_.traces(), *page.view, FrameKind::kNext, page.view_number, first,
                                       static_cast<std::size_t>(end - first)));
  page.next_column = end;
}

void Hub::publishAnswers(Page& page) {
  while (true) {
    const auto answer = page.link->answer(std::chrono::steady_clock::now());
    if (!answer) return;
    page.socket->sendText(shared(responseMessage(answer->seq, statusWord(answer->response.status),
                                                 answer->response.message.view(), valuesOf(answer->response),
                                                 answer->sightings)));
  }
}

void Hub::tell(const std::string& message) {
  const auto text = shared(message);
  for (const auto& page : pages_) {
    if (page->right != PageRight::kNothing) page->socket->sendText(text);
  }
}

}  // namespace rc10::web
