#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace rc10 {

/// Ids of the accounts in the files passwd and group of the folder `etc`; empty if they have none of that
/// name. Not by getpwnam() and getgrnam(), which would load modules of NSS, into locked memory or a sandbox.
[[nodiscard]] std::optional<uid_t> userId(const std::string& name, const std::string& etc = "/etc");
[[nodiscard]] std::optional<gid_t> groupId(const std::string& name, const std::string& etc = "/etc");

}  // namespace rc10
