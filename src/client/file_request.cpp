#include "client/file_request.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "app/errno_text.hpp"
#include "link/unix_address.hpp"

namespace rc10::client {
namespace {

constexpr std::array<const char*, 3> kVerbs{"check", "install", "restart"};
constexpr std::string_view kDone = "done";
constexpr std::string_view kRefused = "refused";
constexpr std::string_view kNoHash = "-";
constexpr std::size_t kHashSize = 64;

// A name of a file, without a folder: those of robots (0-9, a-z, _, -), and of instances of the unit.
bool isName(std::string_view text) {
  constexpr std::size_t kMost = 31;
  return !text.empty() && text.size() <= kMost && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

bool isHash(std::string_view text) {
  return text.size() == kHashSize && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string_view takeWord(std::string_view& line) {
  const auto end = std::min(line.find(' '), line.size());
  const auto word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

std::pair<std::string_view, std::string_view> firstLine(std::string_view bytes) {
  const auto end = std::min(bytes.find('\n'), bytes.size());
  return {bytes.substr(0, end), bytes.substr(std::min(end + 1, bytes.size()))};
}

std::string notThere(const std::string& path, int error) {
  switch (error) {
    case ENOENT:
    case ECONNREFUSED:
      return "this robot lets nobody change its file from a page or by rc10ctl: nobody listens at " + path +
             "; docs/studio.md, \"The root helper\"";
    case EACCES:
      return "no permission for " + path +
             ": its group is rc10 (`sudo usermod -aG rc10 $USER`, then log in again)";
    default: return "cannot connect to " + path + ": " + errnoText(error);
  }
}

}  // namespace

const char* toString(FileVerb verb) noexcept { return kVerbs[static_cast<std::size_t>(verb)]; }

Result<std::string> bytesOf(const FileRequest& request) {
  if (!isName(request.robot))
    return fail("'" + request.robot + "' is not the name of a robot: 1 to 31 of a-z, 0-9, _ and -");
  if (request.text.size() > FileRequest::kMostTextBytes)
    return fail("the file is larger than 128 KiB: shorten it, or install it by hand");
  if (!request.replaces.empty() && !isHash(request.replaces))
    return fail("the file that is replaced is named by its SHA-256, 64 digits of 0-9 and a-f");
  return std::string{toString(request.verb)} + " " + request.robot + " " +
         (request.replaces.empty() ? std::string{kNoHash} : request.replaces) + "\n" + request.text;
}

Result<FileRequest> parseFileRequest(std::string_view bytes) {
  auto [head, text] = firstLine(bytes);
  const auto verb = takeWord(head);
  const auto robot = takeWord(head);
  const auto hash = takeWord(head);
  const auto* const known = std::find(kVerbs.begin(), kVerbs.end(), verb);
  if (known == kVerbs.end() || !isName(robot) || !(hash == kNoHash || isHash(hash)) || !head.empty() ||
      text.size() > FileRequest::kMostTextBytes)
    return fail("the request is not one of rc10-config: check, install or restart, a robot and a SHA-256");
  return FileRequest{.verb = static_cast<FileVerb>(known - kVerbs.begin()),
                     .robot = std::string{robot},
                     .replaces = hash == kNoHash ? std::string{} : std::string{hash},
                     .text = std::string{text}};
}

std::string bytesOf(const FileAnswer& answer) {
  std::string bytes{answer.done ? kDone : kRefused};
  bytes.append("\n").append(answer.message);
  bytes.resize(std::min(bytes.size(), FileAnswer::kMostBytes));
  return bytes;
}

Result<FileAnswer> parseFileAnswer(std::string_view bytes) {
  const auto [word, message] = firstLine(bytes);
  if (word != kDone && word != kRefused) return fail("rc10-config is of another build: restart rc10-web");
  return FileAnswer{.done = word == kDone, .message = std::string{message}};
}

Result<FileCall> FileCall::send(const FileRequest& request, MonotonicTime now,
                                const std::string& socket_path) {
  const auto bytes = bytesOf(request);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto address = link::unixAddress(socket_path);
  if (!address) return fail(notThere(socket_path, ENAMETOOLONG));
  UniqueFd socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (!socket) return fail("no socket: " + errnoText(errno));
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof(*address)) != 0)
    return fail(notThere(socket_path, errno));
  // The kernel's default has room for it.
  if (::send(socket.get(), bytes->data(), bytes->size(), MSG_NOSIGNAL) < 0)
    return fail("rc10-config takes nothing: " + errnoText(errno));
  return FileCall{std::move(socket), now + kPatience};
}

std::optional<Result<FileAnswer>> FileCall::poll(MonotonicTime now) {
  std::string bytes(FileAnswer::kMostBytes, '\0');
  const auto size = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) {
    if (now < deadline_) return std::nullopt;
    return fail("rc10-config does not answer: `journalctl -u 'rc10-config@*'`");
  }
  if (size <= 0) return fail("rc10-config ended without an answer: `journalctl -u 'rc10-config@*'`");
  return parseFileAnswer(std::string_view{bytes}.substr(0, static_cast<std::size_t>(size)));
}

}  // namespace rc10::client
