#include "gateway/sandbox.hpp"

#include <grp.h>
#include <linux/netlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>

#include "app/account_ids.hpp"
#include "sandbox/rights.hpp"
#include "sandbox/system_calls.hpp"

namespace rc10::gateway {
namespace {

constexpr sandbox::Bounds kBounds{.memory_bytes = rlim_t{256} << 20U, .files = 32};

// Rights of root; without a user of its own, `nobody`, who owns no file.
Result<void> leaveRoot() {
  if (::geteuid() != 0) return {};
  constexpr const char* kUser = "rc10-lcm";
  constexpr uid_t kNobody = 65534;
  const auto user = userId(kUser).value_or(kNobody);
  if (::setgroups(0, nullptr) == 0 && ::setresgid(user, user, user) == 0 &&
      ::setresuid(user, user, user) == 0)
    return {};
  // In a user namespace without other users root is an ordinary user of the computer.
  return errno == EINVAL || errno == EPERM ? Result<void>{} : sandbox::notDropped("user", errno);
}

// The kinds of LCM and of the question for its route. The kernel takes flags out of the type.
void allowSockets(sandbox::SystemCalls& calls) {
  using sandbox::argument;
  constexpr std::uint32_t kTypeMask = 0xF;
  calls.allow(SCMP_SYS(socket), argument(0, AF_INET), argument(1, SOCK_DGRAM, kTypeMask), argument(2, 0));
  calls.allow(SCMP_SYS(socket), argument(0, AF_NETLINK), argument(1, SOCK_RAW, kTypeMask),
              argument(2, NETLINK_ROUTE));
  calls.allow(SCMP_SYS(bind));
  calls.allow(SCMP_SYS(setsockopt), argument(1, SOL_SOCKET));
  calls.allow(SCMP_SYS(setsockopt), argument(1, IPPROTO_IP));
  calls.allow(SCMP_SYS(ioctl), argument(1, SIOCGIFNAME));
}

}  // namespace

Result<void> enterSandbox(int parent) {
  if (auto result = sandbox::bound(kBounds); !result) return result;
  if (auto result = leaveRoot(); !result) return result;
  if (auto result = sandbox::dropCapabilities(); !result) return result;
  if (::getppid() == parent) {
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);  // after the capabilities: changing them may clear it
    if (::getppid() != parent) return fail("rc10d has ended");
  }
  sandbox::SystemCalls calls;
  allowSockets(calls);
  return calls.keepToThese();
}

}  // namespace rc10::gateway
