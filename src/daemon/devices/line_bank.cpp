#include "daemon/devices/line_bank.hpp"

#include <sys/eventfd.h>

#include <cerrno>

#include <fmt/format.h>

#include "app/errno_text.hpp"

namespace rc10 {

void LineBank::look(GpioImage& image) const noexcept {
  const auto seen = seen_.load(std::memory_order_relaxed);
  image.open = (seen & kOpen) != 0;
  image.inputs = static_cast<std::uint32_t>(seen & kLines);
  image.unwritten = static_cast<std::uint32_t>(seen >> kUnwrittenShift & kLines);
  image.readings = static_cast<std::uint32_t>(seen >> kReadingsShift);
}

void LineBank::want(std::uint32_t levels) noexcept {
  if (wanted_.exchange(levels, std::memory_order_relaxed) != levels) (void)::eventfd_write(wake_, 1);
}

void LineBank::show(std::uint32_t inputs, std::uint32_t unwritten) noexcept {
  const auto readings = (seen_.load(std::memory_order_relaxed) >> kReadingsShift) + 1;
  seen_.store(
      readings << kReadingsShift | kOpen | (unwritten & kLines) << kUnwrittenShift | (inputs & kLines),
      std::memory_order_relaxed);
}

void LineBank::showUnread(std::uint32_t unwritten) noexcept {
  const auto kept = seen_.load(std::memory_order_relaxed) & ~(kLines << kUnwrittenShift);
  seen_.store(kept | (unwritten & kLines) << kUnwrittenShift, std::memory_order_relaxed);
}

Result<std::unique_ptr<LineBanks>> LineBanks::create(std::vector<LineBank::Settings> banks) {
  UniqueFd wake{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  if (!wake) return fail(fmt::format("eventfd: {}", errnoText(errno)));
  auto all = std::unique_ptr<LineBanks>(new LineBanks(std::move(wake)));
  for (auto& settings : banks)
    all->banks_.push_back(std::make_unique<LineBank>(std::move(settings), all->wake()));
  return all;
}

}  // namespace rc10
