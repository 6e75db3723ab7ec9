#pragma once

#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "bus/can_link_news.hpp"

namespace rc10 {

/// Hears from the kernel (rtnetlink) which interfaces were changed.
class CanLinkWatch {
 public:
  struct News {
    std::vector<CanLinkNews> links;
    bool lost = false;  ///< The kernel had more than it could keep: anything may have changed.
  };

  [[nodiscard]] static Result<CanLinkWatch> open();

  /// To be polled for reading.
  [[nodiscard]] int fd() const noexcept { return fd_.get(); }

  /// All that was told since the last time; it does not wait.
  [[nodiscard]] Result<News> read() const;

 private:
  explicit CanLinkWatch(UniqueFd fd) noexcept : fd_(std::move(fd)) {}

  UniqueFd fd_;
};

}  // namespace rc10
