#include "daemon/interfaces/can_fd_setup.hpp"

#include <libmnl/libmnl.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <memory>

namespace rc10 {
namespace {

constexpr std::uint32_t kSequence = 1;  // one question, one answer, one socket

struct SocketCloser {
  void operator()(mnl_socket* socket) const noexcept { (void)mnl_socket_close(socket); }
};
using Socket = std::unique_ptr<mnl_socket, SocketCloser>;

// The kernel counts sample points in tenths of a percent, and chooses where there is none.
[[nodiscard]] can_bittiming timing(int bitrate, double sample_point) noexcept {
  can_bittiming timing{};
  timing.bitrate = static_cast<std::uint32_t>(bitrate);
  timing.sample_point = static_cast<std::uint32_t>(std::lround(sample_point * 1000.0));
  return timing;
}

[[nodiscard]] Socket openSocket() {
  Socket socket{mnl_socket_open2(NETLINK_ROUTE, SOCK_CLOEXEC)};
  if (!socket || mnl_socket_bind(socket.get(), 0, MNL_SOCKET_AUTOPID) < 0) return nullptr;
  const timeval patience{.tv_sec = 1, .tv_usec = 0};
  (void)::setsockopt(mnl_socket_get_fd(socket.get()), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  // With its reason in words, which a kernel may have, and without our message repeated before it.
  int on = 1;
  (void)mnl_socket_setsockopt(socket.get(), NETLINK_EXT_ACK, &on, sizeof on);
  (void)mnl_socket_setsockopt(socket.get(), NETLINK_CAP_ACK, &on, sizeof on);
  return socket;
}

int takeReason(const nlattr* attribute, void* data) {
  if (mnl_attr_get_type(attribute) == NLMSGERR_ATTR_MSG &&
      mnl_attr_validate(attribute, MNL_TYPE_NUL_STRING) >= 0) {
    static_cast<KernelRefusal*>(data)->reason = mnl_attr_get_str(attribute);
  }
  return MNL_CB_OK;
}

int takeAnswer(const nlmsghdr* header, void* data) {
  auto& refusal = *static_cast<KernelRefusal*>(data);
  if (mnl_nlmsg_get_payload_len(header) < sizeof(nlmsgerr)) {
    refusal.error = EBADMSG;
    return MNL_CB_STOP;
  }
  refusal.error = -static_cast<const nlmsgerr*>(mnl_nlmsg_get_payload(header))->error;
  if ((header->nlmsg_flags & NLM_F_ACK_TLVS) != 0)
    (void)mnl_attr_parse(header, sizeof(nlmsgerr), takeReason, data);
  return MNL_CB_STOP;
}

}  // namespace

std::span<const std::byte> fdSetupMessage(std::span<std::byte, kFdSetupRoom> room, unsigned interface_index,
                                          const CanLink& seen, const CanLinkSettings& wanted) {
  auto* header = mnl_nlmsg_put_header(room.data());
  header->nlmsg_type = RTM_NEWLINK;
  header->nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
  header->nlmsg_seq = kSequence;
  auto* info = static_cast<ifinfomsg*>(mnl_nlmsg_put_extra_header(header, sizeof(ifinfomsg)));
  info->ifi_family = AF_UNSPEC;
  info->ifi_index = static_cast<int>(interface_index);

  auto* link_info = mnl_attr_nest_start(header, IFLA_LINKINFO);
  mnl_attr_put_str(header, IFLA_INFO_KIND, "can");
  auto* settings = mnl_attr_nest_start(header, IFLA_INFO_DATA);
  // All in one message: the kernel takes FD mode only together with both timings.
  const auto nominal = timing(wanted.bitrate, wanted.sample_point);
  mnl_attr_put(header, IFLA_CAN_BITTIMING, sizeof nominal, &nominal);
  const auto data = timing(wanted.data_bitrate, wanted.data_sample_point);
  mnl_attr_put(header, IFLA_CAN_DATA_BITTIMING, sizeof data, &data);
  const can_ctrlmode mode{.mask = CAN_CTRLMODE_FD | hinderingModes(seen), .flags = CAN_CTRLMODE_FD};
  mnl_attr_put(header, IFLA_CAN_CTRLMODE, sizeof mode, &mode);
  mnl_attr_put_u32(header, IFLA_CAN_RESTART_MS, 0);
  mnl_attr_nest_end(header, settings);
  mnl_attr_nest_end(header, link_info);
  return room.first(header->nlmsg_len);
}

tl::expected<void, KernelRefusal> setUpFd(const std::string& interface, const CanLink& seen,
                                          const CanLinkSettings& wanted) {
  const auto refused = [](int error) { return tl::unexpected(KernelRefusal{.error = error, .reason = {}}); };
  const unsigned index = ::if_nametoindex(interface.c_str());
  if (index == 0) return refused(errno);
  const auto socket = openSocket();
  if (!socket) return refused(errno);
  alignas(nlmsghdr) std::array<std::byte, kFdSetupRoom> room{};
  const auto message = fdSetupMessage(room, index, seen, wanted);
  if (mnl_socket_sendto(socket.get(), message.data(), message.size()) < 0) return refused(errno);

  KernelRefusal answer;
  std::array<mnl_cb_t, NLMSG_ERROR + 1> on_control{};
  on_control[NLMSG_ERROR] = takeAnswer;
  alignas(nlmsghdr) std::array<std::byte, 4096> received{};
  int verdict = MNL_CB_OK;
  while (verdict == MNL_CB_OK) {
    const auto size = mnl_socket_recvfrom(socket.get(), received.data(), received.size());
    if (size < 0) return refused(errno == EAGAIN ? ETIMEDOUT : errno);
    verdict = mnl_cb_run2(received.data(), static_cast<std::size_t>(size), kSequence,
                          mnl_socket_get_portid(socket.get()), nullptr, &answer, on_control.data(),
                          static_cast<unsigned>(on_control.size()));
    if (verdict < MNL_CB_STOP) return refused(errno);
  }
  if (answer.error != 0) return tl::unexpected(answer);
  return {};
}

}  // namespace rc10
