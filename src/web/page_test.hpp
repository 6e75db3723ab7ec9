#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "app/result.hpp"
#include "app/time.hpp"
#include "client/link_client.hpp"
#include "client/motion/motion_report.hpp"
#include "client/motion/motion_run.hpp"
#include "client/motion/motion_session.hpp"
#include "web/bounded_child.hpp"
#include "web/page_request.hpp"

namespace rc10::web {

/// A test of motion that a page has started, over a connection of its own under the page's name. No target
/// outlives the time that the page's last renewal gives it. Nothing but begin() waits.
class PageTest {
 public:
  struct Opening {
    std::string client;
    std::string token;  ///< Token of an entry of `clients` that the page has shown.
    std::string socket_path;
  };
  /// `age`: time that its message took. The error is a sentence for the page.
  [[nodiscard]] static Result<std::unique_ptr<PageTest>> begin(const StartTest& wanted,
                                                               const Opening& opening, MonotonicTime now,
                                                               Duration age);
  /// Lets the motor go.
  ~PageTest();
  PageTest(const PageTest&) = delete;
  PageTest& operator=(const PageTest&) = delete;

  [[nodiscard]] std::int64_t seq() const noexcept { return seq_; }
  /// The page has said so long ago that it may go on.
  void renew(MonotonicTime now, Duration age) noexcept;
  void end(TestEnd why);

  /// Every client::MotionRun::kSendPeriod, until it is over.
  void turn(MonotonicTime now);
  [[nodiscard]] bool isRunning() const noexcept { return !run_.over(); }
  [[nodiscard]] const client::MotionRun& run() const noexcept { return run_; }
  [[nodiscard]] const char* whatMotorDoes() const noexcept { return session_.whatMotorDoes(); }

 private:
  PageTest(const StartTest& wanted, LinkClient rc10d, client::MotionRun run);

  std::int64_t seq_;
  Duration patience_;  ///< Time for which the page may be silent.
  MonotonicTime until_{};
  LinkClient rc10d_;
  client::MotionRun run_;
  client::MotionSession session_;
};

/// The numbers of a test that is over, computed in a process beside the server's: a long curve takes seconds,
/// and STOP must not wait for them.
class TestEvaluation {
 public:
  TestEvaluation(const PageTest& test, MonotonicTime now);

  /// The message for the page, once; nothing: not yet. Without its numbers if there is no process for them.
  [[nodiscard]] std::optional<std::string> message(MonotonicTime now);
  [[nodiscard]] std::int64_t seq() const noexcept { return seq_; }
  [[nodiscard]] const client::Curve& curve() const noexcept { return run_.curve(); }

 private:
  [[nodiscard]] std::string done(const client::MotionReport& report) const;

  std::int64_t seq_;
  client::MotionRun run_;
  const char* doing_;
  MonotonicTime deadline_;
  bool told_ = false;
  std::optional<BoundedChild> child_;
};

}  // namespace rc10::web
