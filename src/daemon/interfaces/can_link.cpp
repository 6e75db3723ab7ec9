#include "daemon/interfaces/can_link.hpp"

#include <libsocketcan.h>
#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>

#include "daemon/interfaces/can_fd_setup.hpp"

namespace rc10 {
namespace {

// Bits of the second word of the capability sets start at 32.
static_assert(CAP_NET_ADMIN < 32);

/// One interface on its way from the state that was read to the one that is wanted.
class LinkSetup {
 public:
  LinkSetup(const std::string& interface, const CanLink& seen, const CanLinkSettings& wanted)
      : interface_(interface), seen_(seen), wanted_(wanted) {}

  [[nodiscard]] Result<void> run() const {
    // Asked first: libsocketcan would write to stderr what is refused.
    if (!mayManageLinks()) return failed("take it down", EPERM);
    if (can_do_stop(interface_.c_str()) != 0) return failed("take it down", errno);
    // All of them are refused while the interface is up.
    if (auto set = wanted_.data_bitrate != 0 ? setFd() : setClassic(); !set) return set;
    if (auto as_wanted = compare(); !as_wanted) return as_wanted;
    if (can_do_start(interface_.c_str()) != 0) return failed("bring it up", errno);
    return {};
  }

 private:
  [[nodiscard]] Result<void> setClassic() const {
    const char* const name = interface_.c_str();
    const auto sample_point = static_cast<std::uint32_t>(std::lround(wanted_.sample_point * 1000.0));
    if (can_set_bitrate_samplepoint(name, static_cast<std::uint32_t>(wanted_.bitrate), sample_point) != 0)
      return failed("set " + bitrates(wanted_), errno);
    can_ctrlmode off{.mask = hinderingModes(seen_), .flags = 0};
    if (seen_.fd_on) off.mask |= CAN_CTRLMODE_FD;
    if (off.mask != 0 && can_set_ctrlmode(name, &off) != 0)
      return failed("make it a classic interface", errno);
    if (can_set_restart_ms(name, 0) != 0) return failed("set restart-ms 0", errno);
    return {};
  }

  [[nodiscard]] Result<void> setFd() const {
    const auto set = setUpFd(interface_, seen_, wanted_);
    if (!set)
      return failed("set " + bitrates(wanted_) + " and CAN FD", set.error().error, set.error().reason);
    return {};
  }

  [[nodiscard]] Result<void> compare() const {
    const auto now = readCanLink(interface_);
    if (!now) return tl::unexpected(now.error());
    const auto wrong = wrongSetting(interface_, *now, wanted_);
    if (wrong.empty()) return {};
    return fail("CAN interface '" + interface_ + "': its driver took " + bitrates(wanted_) +
                " and made something else of it: " + wrong +
                "; it is left down. Choose what its clock can make (`ip -details link show " + interface_ +
                "`), or another program sets it too: only one may");
  }

  [[nodiscard]] tl::unexpected<Error> failed(const std::string& what, int error,
                                             const std::string& reason = {}) const {
    std::string fix = reason.empty() ? "" : " (" + reason + ")";
    const auto by_hand = "; by hand: " + restartCommand(interface_, seen_, wanted_);
    if (error == EPERM) {
      fix +=
          "; rc10d needs CAP_NET_ADMIN for `manage_link`: the unit rc10d.service gives it "
          "(AmbientCapabilities=), "
          "or run it with sudo, or remove manage_link";
    } else if (error == EOPNOTSUPP && wanted_.data_bitrate != 0) {
      fix +=
          "; the controller may know classic CAN only: remove data_bitrate, or take one for CAN FD" + by_hand;
    } else if (error == EINVAL || error == ERANGE || error == EDOM) {
      fix += "; the driver may not know this bit rate or sample point: `ip -details link show " + interface_ +
             "` shows its bounds" + by_hand;
    } else if (error == EBUSY) {
      fix += "; another program has brought it up meanwhile: only one may manage it" + by_hand;
    } else {
      fix += by_hand;
    }
    return canLinkFailure(interface_, what, error, fix);
  }

  const std::string& interface_;
  const CanLink& seen_;
  const CanLinkSettings& wanted_;
};

}  // namespace

Result<void> restartCanLink(const std::string& interface, const CanLinkSettings& wanted) {
  const auto link = readCanLink(interface);
  if (!link) return tl::unexpected(link.error());
  if (!link->isController()) {
    if (link->kind.empty()) return fail("'" + interface + "' is not a CAN interface");
    return fail("CAN interface '" + interface + "': is no CAN controller (" + link->kind +
                "), there is no bit rate to set; remove manage_link, and type: " +
                upCommand(interface, *link, wanted));
  }
  return LinkSetup(interface, *link, wanted).run();
}

bool mayManageLinks() noexcept {
  __user_cap_header_struct header{};
  header.version = _LINUX_CAPABILITY_VERSION_3;
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
  return ::syscall(SYS_capget, &header, sets.data()) == 0 && (sets[0].effective & (1U << CAP_NET_ADMIN)) != 0;
}

}  // namespace rc10
