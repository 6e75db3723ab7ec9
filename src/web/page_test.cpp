#include "web/page_test.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "web/page_messages.hpp"

namespace rc10::web {
namespace {

constexpr std::int32_t kLeaseMs = client::MotionRun::kLease / std::chrono::milliseconds{1};
constexpr Duration kOpeningPatience = std::chrono::milliseconds{200};
constexpr ChildLimits kEvaluation{.cpu_s = 20, .patience = std::chrono::seconds{60}};

}  // namespace

Result<std::unique_ptr<PageTest>> PageTest::begin(const StartTest& wanted, const Opening& opening,
                                                  MonotonicTime now, Duration age) {
  auto settings = client::settingsOf(wanted.plan, opening.client);
  if (!settings) return tl::unexpected(settings.error());
  // The plan's time is that of the page's silence: this process renews each target long before.
  settings->validity_ms = std::min(settings->validity_ms, kLeaseMs);
  auto connection = LinkClient::connect(opening.socket_path, {.name = opening.client,
                                                              .subscriptions = link::kStates | link::kEvents,
                                                              .token = opening.token,
                                                              .timeout = kOpeningPatience});
  if (!connection) return tl::unexpected(connection.error());
  auto run = client::MotionRun::of(connection->welcome(), *settings);
  if (!run) return tl::unexpected(run.error());
  std::unique_ptr<PageTest> test(new PageTest(wanted, std::move(*connection), std::move(*run)));
  test->renew(now, age);
  return test;
}

PageTest::PageTest(const StartTest& wanted, LinkClient rc10d, client::MotionRun run)
    : seq_(wanted.seq),
      patience_(std::chrono::milliseconds{wanted.plan.dead_man_ms}),
      rc10d_(std::move(rc10d)),
      run_(std::move(run)),
      session_(rc10d_, run_, wanted.priority) {}

PageTest::~PageTest() {
  end(TestEnd::kLeft);
  turn(std::chrono::steady_clock::now());
}

void PageTest::renew(MonotonicTime now, Duration age) noexcept {
  until_ = std::max(until_, now + patience_ - age);
}

void PageTest::end(TestEnd why) {
  run_.end(client::Criterion::kInterrupted,
           why == TestEnd::kStopped ? "stopped on the page"
                                    : "the page was hidden or left: keep it in front until the end");
}

// A silence is told before what rc10d tells of its consequence.
void PageTest::turn(MonotonicTime now) {
  if (now >= until_) {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(patience_).count();
    run_.end(client::Criterion::kSilence,
             "no word from the page for " + std::to_string(ms) +
                 " ms: close other programs there, use a better network, or allow a "
                 "longer silence");
  }
  session_.receive();
  session_.send(now, until_);
}

TestEvaluation::TestEvaluation(const PageTest& test, MonotonicTime now)
    : seq_(test.seq()),
      run_(test.run()),
      doing_(test.whatMotorDoes()),
      deadline_(now + kEvaluation.patience) {}

std::string TestEvaluation::done(const client::MotionReport& report) const {
  return testDoneMessage(seq_, report, run_, doing_);
}

// As many processes as the service has room for: the others wait for theirs.
std::optional<std::string> TestEvaluation::message(MonotonicTime now) {
  if (told_) return std::nullopt;
  if (!child_) {
    auto started = BoundedChild::start([this] { return done(client::reportOf(run_)); }, now, kEvaluation);
    if (started) child_.emplace(std::move(*started));
  }
  auto answer = child_ ? child_->poll(now) : std::nullopt;
  if (!answer && now < deadline_) return std::nullopt;
  told_ = true;
  child_.reset();
  if (answer && *answer) return std::move(**answer);
  client::MotionReport without_numbers;
  without_numbers.ticks = run_.curve().size();
  return done(without_numbers);
}

}  // namespace rc10::web
