#include "sandbox/file_view.hpp"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>

#include "app/sanitizers.hpp"
#include "app/unique_fd.hpp"
#include "sandbox/rights.hpp"

namespace rc10::sandbox {
namespace {

// All rights of Landlock's first version: Linux 5.13.
constexpr std::uint64_t kAll = (std::uint64_t{LANDLOCK_ACCESS_FS_MAKE_SYM} << 1U) - 1;
constexpr std::uint64_t kReading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;

Result<void> allowReadingIn(int rules, const std::filesystem::path& folder) {
  const UniqueFd place{::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)};
  if (!place) return {};
  landlock_path_beneath_attr rule{};
  rule.allowed_access = kReading;
  rule.parent_fd = place.get();
  if (::syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) != 0)
    return notDropped("files of " + folder.string(), errno);
  return {};
}

}  // namespace

Result<void> readOnlyBeside(const std::vector<std::string>& folders) {
  if (kSanitized) return {};  // they read files of /proc, and of what they name in a report
  landlock_ruleset_attr attributes{};
  attributes.handled_access_fs = kAll;
  const UniqueFd rules{
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0))};
  if (!rules) return errno == ENOSYS || errno == EOPNOTSUPP ? Result<void>{} : notDropped("Landlock", errno);
  for (const auto& folder : folders) {
    // Without a final slash.
    const auto path = (std::filesystem::absolute(folder) / "x").lexically_normal().parent_path();
    if (auto allowed = allowReadingIn(rules.get(), path); !allowed) return allowed;
    if (const auto beside = path.parent_path(); beside != beside.root_path())
      if (auto allowed = allowReadingIn(rules.get(), beside); !allowed) return allowed;
  }
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return notDropped("PR_SET_NO_NEW_PRIVS", errno);
  if (::syscall(SYS_landlock_restrict_self, rules.get(), 0) != 0) return notDropped("Landlock", errno);
  return {};
}

}  // namespace rc10::sandbox
