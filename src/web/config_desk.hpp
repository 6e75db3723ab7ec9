#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/time.hpp"
#include "client/file_request.hpp"
#include "web/bounded_child.hpp"

namespace rc10::web {

/// Questions of pages about configurations: one after the other, each in a process of its own.
class ConfigDesk {
 public:
  using Work = std::string (*)(std::string_view input);
  struct Question {
    std::uint64_t page = 0;  ///< Number of the page.
    std::int64_t seq = 0;
    std::string head;  ///< Message to the page, up to the JSON of the answer.
    Work work = nullptr;
    std::string input;
    std::optional<client::FileRequest> then =
        std::nullopt;  ///< To be asked for after the answer, which has no head.
  };
  struct Answer {
    std::uint64_t page = 0;
    std::int64_t seq = 0;
    Result<std::string> message;
    std::optional<client::FileRequest> then;
  };

  /// A page has one question of a kind in the queue: the number of the one whose place this takes, if any.
  std::optional<std::int64_t> ask(Question question);
  /// The page is gone.
  void forget(std::uint64_t page);
  /// The next answer, if there is one. Never waits.
  [[nodiscard]] std::optional<Answer> turn(MonotonicTime now);

 private:
  [[nodiscard]] Answer answered(Result<std::string> json);

  std::deque<Question> waiting_;
  std::optional<Question> asked_;
  std::optional<BoundedChild> child_;
};

}  // namespace rc10::web
