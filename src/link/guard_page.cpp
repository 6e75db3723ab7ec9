#include "link/guard_page.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <string>
#include <utility>

#include "app/errno_text.hpp"

namespace rc10::link {
namespace {

constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

tl::unexpected<Error> failure(const char* what) {
  return fail(std::string("page of rc10-guard: ") + what + ": " + errnoText(errno));
}

void* mapShared(int descriptor) noexcept {
  return ::mmap(nullptr, sizeof(GuardPage), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
}

}  // namespace

Result<SharedGuardPage> SharedGuardPage::create() {
  UniqueFd descriptor{::memfd_create("rc10-guard", MFD_CLOEXEC | MFD_ALLOW_SEALING)};
  if (!descriptor || ::ftruncate(descriptor.get(), sizeof(GuardPage)) != 0 ||
      ::fcntl(descriptor.get(), F_ADD_SEALS, kSeals) != 0)
    return failure("cannot be made");
  void* const memory = mapShared(descriptor.get());
  if (memory == MAP_FAILED) return failure("cannot be mapped");
  return SharedGuardPage{std::move(descriptor), new (memory) GuardPage};
}

Result<SharedGuardPage> SharedGuardPage::map(UniqueFd descriptor) {
  struct stat status {};
  const int seals = ::fcntl(descriptor.get(), F_GET_SEALS);
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0 || ::fstat(descriptor.get(), &status) != 0 ||
      status.st_size < static_cast<off_t>(sizeof(GuardPage)))
    return fail("page of rc10-guard: the descriptor is no sealed page of this version");
  void* const memory = mapShared(descriptor.get());
  if (memory == MAP_FAILED) return failure("cannot be mapped");
  return SharedGuardPage{std::move(descriptor), std::launder(static_cast<GuardPage*>(memory))};
}

SharedGuardPage::SharedGuardPage(SharedGuardPage&& other) noexcept
    : descriptor_(std::move(other.descriptor_)), page_(std::exchange(other.page_, nullptr)) {}

SharedGuardPage& SharedGuardPage::operator=(SharedGuardPage&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(page_, other.page_);
  return *this;
}

SharedGuardPage::~SharedGuardPage() {
  if (page_ != nullptr) (void)::munmap(page_, sizeof(GuardPage));
}

}  // namespace rc10::link
