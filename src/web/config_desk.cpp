#include "web/config_desk.hpp"

#include <algorithm>
#include <utility>

namespace rc10::web {

std::optional<std::int64_t> ConfigDesk::ask(Question question) {
  const auto before = std::find_if(waiting_.begin(), waiting_.end(), [&](const Question& other) {
    return other.page == question.page && other.work == question.work;
  });
  if (before == waiting_.end()) {
    waiting_.push_back(std::move(question));
    return std::nullopt;
  }
  const auto replaced = before->seq;
  *before = std::move(question);
  return replaced;
}

void ConfigDesk::forget(std::uint64_t page) {
  std::erase_if(waiting_, [&](const Question& question) { return question.page == page; });
  if (!asked_ || asked_->page != page) return;
  child_.reset();
  asked_.reset();
}

std::optional<ConfigDesk::Answer> ConfigDesk::turn(MonotonicTime now) {
  if (child_) {
    auto json = child_->poll(now);
    if (!json) return std::nullopt;
    child_.reset();
    return answered(std::move(*json));
  }
  if (waiting_.empty()) return std::nullopt;
  asked_ = std::move(waiting_.front());
  waiting_.pop_front();
  auto child = BoundedChild::start([&] { return asked_->work(asked_->input); }, now);
  if (child) {
    child_.emplace(std::move(*child));
    return std::nullopt;
  }
  return answered(tl::unexpected(child.error()));
}

ConfigDesk::Answer ConfigDesk::answered(Result<std::string> json) {
  auto asked = std::exchange(asked_, std::nullopt).value_or(Question{});
  Answer answer{
      .page = asked.page, .seq = asked.seq, .message = std::move(json), .then = std::move(asked.then)};
  if (answer.message && !answer.then) *answer.message = asked.head + *answer.message + "}";
  return answer;
}

}  // namespace rc10::web
