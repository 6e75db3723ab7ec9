#include "link/descriptor_message.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace rc10::link {
namespace {

constexpr std::size_t kControlBytes = CMSG_SPACE(DescriptorMessage::kMaxDescriptors * sizeof(int));

}  // namespace

bool sendWithDescriptors(int socket, std::string_view text, std::span<const int> descriptors) {
  if (descriptors.size() > DescriptorMessage::kMaxDescriptors || text.size() > DescriptorMessage::kMaxBytes) {
    errno = EMSGSIZE;
    return false;
  }
  alignas(cmsghdr) std::array<char, kControlBytes> control{};
  iovec bytes{.iov_base = const_cast<char*>(text.data()), .iov_len = text.size()};
  msghdr header{};
  header.msg_iov = &bytes;
  header.msg_iovlen = 1;
  if (!descriptors.empty()) {
    header.msg_control = control.data();
    header.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* const rights = CMSG_FIRSTHDR(&header);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(rights), descriptors.data(), descriptors.size_bytes());
  }
  return ::sendmsg(socket, &header, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
}

bool receiveWithDescriptors(int socket, DescriptorMessage& message) {
  alignas(cmsghdr) std::array<char, kControlBytes> control{};
  message.text.resize(DescriptorMessage::kMaxBytes);
  message.descriptors.clear();
  iovec bytes{.iov_base = message.text.data(), .iov_len = message.text.size()};
  msghdr header{};
  header.msg_iov = &bytes;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  const auto size = ::recvmsg(socket, &header, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  message.text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  for (const cmsghdr* part = CMSG_FIRSTHDR(&header); size >= 0 && part != nullptr;
       part = CMSG_NXTHDR(&header, const_cast<cmsghdr*>(part))) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
    const auto count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int descriptor = -1;
      std::memcpy(&descriptor, CMSG_DATA(part) + i * sizeof(int), sizeof descriptor);
      message.descriptors.emplace_back(descriptor);
    }
  }
  if (size == 0) errno = 0;
  if (size > 0 && (header.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) != 0) errno = EMSGSIZE;
  return size > 0 && (header.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) == 0;
}

}  // namespace rc10::link
