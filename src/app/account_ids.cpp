#include "app/account_ids.hpp"

#include <grp.h>
#include <pwd.h>

#include <cstdio>
#include <memory>

namespace rc10 {
namespace {

struct AccountFileCloser {
  void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
};
using AccountFile = std::unique_ptr<std::FILE, AccountFileCloser>;

}  // namespace

std::optional<uid_t> userId(const std::string& name, const std::string& etc) {
  const AccountFile file(std::fopen((etc + "/passwd").c_str(), "re"));
  if (!file) return std::nullopt;
  while (const passwd* entry = ::fgetpwent(file.get())) {
    if (entry->pw_name == name) return entry->pw_uid;
  }
  return std::nullopt;
}

std::optional<gid_t> groupId(const std::string& name, const std::string& etc) {
  const AccountFile file(std::fopen((etc + "/group").c_str(), "re"));
  if (!file) return std::nullopt;
  while (const group* entry = ::fgetgrent(file.get())) {
    if (entry->gr_name == name) return entry->gr_gid;
  }
  return std::nullopt;
}

}  // namespace rc10
