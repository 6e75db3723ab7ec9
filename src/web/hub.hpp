#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "web/access.hpp"
#include "web/columns_frame.hpp"
#include "web/config_desk.hpp"
#include "web/hold_gap.hpp"
#include "web/page_link.hpp"
#include "web/page_request.hpp"
#include "web/page_test.hpp"
#include "web/recordings.hpp"
#include "web/renewal_age.hpp"
#include "web/robot_feed.hpp"
#include "web/running_config.hpp"

namespace rc10::web {

/// The connection to one open page. Nothing here waits for it.
class PageSocket {
 public:
  PageSocket() = default;
  PageSocket(const PageSocket&) = delete;
  PageSocket& operator=(const PageSocket&) = delete;
  virtual ~PageSocket() = default;

  using Text = std::shared_ptr<const std::string>;
  virtual void sendText(Text text) = 0;
  virtual void sendBinary(std::vector<std::byte> frame) = 0;
  /// The page has much unread: newer messages would wait behind it, so it gets fewer.
  [[nodiscard]] virtual bool behind() const = 0;
  virtual void close() = 0;
};

/// The pages and the robot, without a network and without waiting: what the pages are told, and what they
/// ask.
class Hub {
 public:
  /// `file_socket`: of the root helper.
  Hub(std::optional<std::string> robot, std::string token, Recordings recordings,
      std::string file_socket = client::kFileSocket);

  /// A page has been opened; `socket` is told of until leave().
  void join(PageSocket& socket, bool loopback, std::string_view address);
  void leave(PageSocket& socket);
  void handle(PageSocket& socket, std::string_view message, MonotonicTime now);

  /// A hundred times a second.
  void turn();
  /// Tests of motion run: runTests() is to be called every client::MotionRun::kSendPeriod.
  [[nodiscard]] bool isTesting() const noexcept;
  void runTests(MonotonicTime now);

 private:
  struct Page {
    PageSocket* socket = nullptr;
    std::uint64_t number = 0;
    bool loopback = false;
    PageRight right = PageRight::kNothing;
    std::string name;
    std::optional<View> view;
    std::uint32_t view_number = 0;
    std::int64_t next_column = 0;
    std::unique_ptr<PageLink> link;
    RenewalAge renewals;
    HoldGap hold;
    std::optional<OpenRecording> recording;
    std::uint32_t recording_number = 0;
    std::unique_ptr<PageTest> test;
    std::optional<client::FileCall> file_call;
    std::int64_t file_seq = 0;
    bool changes_file = false;  ///< One change of its file is under way, from its message to its answer.
    std::unique_ptr<TestEvaluation> evaluation;
  };

  struct ShownToken {
    std::uint64_t page = 0;
    std::string token;
  };

  [[nodiscard]] Page* pageOf(const PageSocket& socket) noexcept;
  void greet(Page& page);
  void take(Page& page, ShowToken shown, MonotonicTime now);
  void judgeTokens(MonotonicTime now);
  void choose(Page& page, const ChooseView& wanted);
  void answer(Page& page, const AskRange& wanted);
  void ask(Page& page, const AskRobot& wanted, MonotonicTime now, Duration age);
  void open(Page& page, const AskRecording& wanted);
  void sendPiece(Page& page, const AskPiece& wanted);
  void drive(Page& page, const DriveMotor& wanted, MonotonicTime now, Duration age);
  void showConfigTo(const Page& page, const AskConfig& wanted);
  void check(const Page& page, CheckConfig wanted);
  void change(Page& page, const ChangeFile& wanted, Duration age);
  void askHelper(Page& page, std::int64_t seq, const Result<std::string>& may,
                 const client::FileRequest& request);
  void publishFileAnswer(Page& page);
  [[nodiscard]] FoundConfig shownConfig() const;
  void askDesk(const Page& page, ConfigDesk::Question question);
  void answerConfigs();
  void begin(Page& page, const StartTest& wanted, MonotonicTime now, Duration age);
  void sendCurve(Page& page, const AskCurve& wanted);
  void publishTests(MonotonicTime now);
  [[nodiscard]] std::string downNow() const;
  [[nodiscard]] std::string whyNotMoving(const Page& page) const;
  [[nodiscard]] static std::string whyTooLate(Duration age);
  /// Each signal that a page draws, once.
  [[nodiscard]] std::vector<link::TraceSignal> viewedSignals() const;
  [[nodiscard]] bool hasRoomFor(const link::TraceSignal& signal) const;
  void chooseTraces();
  void watchRobot();
  void tellDown();
  void publish();
  void publishColumns(Page& page);
  void publishAnswers(Page& page);
  void tell(const std::string& message);

  std::optional<std::string> robot_;
  RobotFeed feed_;
  std::string token_;
  std::deque<ShownToken> shown_tokens_;  ///< Not judged yet; of each page one at most.
  MonotonicTime next_judgement_{};
  Recordings recordings_;
  std::string file_socket_;
  ConfigDesk configs_;
  std::vector<std::unique_ptr<Page>> pages_;
  std::uint64_t opened_ = 0;
  std::uint64_t turns_ = 0;
  std::string told_down_;
};

}  // namespace rc10::web
