#include "client/page_token.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "app/unique_fd.hpp"
#include "link/run_dir.hpp"

namespace rc10::client {
namespace {

bool isPageToken(std::string_view text) {
  return text.size() == kPageTokenLength && std::all_of(text.begin(), text.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0;
         });
}

Result<std::optional<std::string>> cannotRead(const std::string& path) {
  return fail("the token in " + path + " cannot be read: " + std::strerror(errno) +
              ". Choose another file with --token-file");
}

}  // namespace

Result<std::string> makePageToken() {
  // 32 signs: each byte gives one without a bias.
  constexpr std::string_view kSigns = "abcdefghijkmnpqrstuvwxyz23456789";
  static_assert(kSigns.size() == 32);
  std::array<unsigned char, kPageTokenLength> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return fail(std::string{"no random numbers: "} + std::strerror(errno));
  std::string token;
  for (const auto byte : random) token += kSigns[byte % kSigns.size()];
  return token;
}

std::string pageTokenPath() { return link::runDir() + "/web-token"; }

Result<std::optional<std::string>> readPageToken(const std::string& path) {
  const UniqueFd file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)};
  if (!file && errno == ENOENT) return std::optional<std::string>{};
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0) return cannotRead(path);
  if (!S_ISREG(status.st_mode) || (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return fail(path + " is open to others than its owner: `chmod 600 " + path +
                "`, or remove it for a new token");
  std::array<char, kPageTokenLength + 2> bytes{};
  const auto size = ::read(file.get(), bytes.data(), bytes.size());
  if (size < 0) return cannotRead(path);
  std::string_view text{bytes.data(), static_cast<std::size_t>(size)};
  if (text.ends_with('\n')) text.remove_suffix(1);
  if (!isPageToken(text)) return fail(path + " holds no token: remove it, and a new one is made");
  return std::optional{std::string{text}};
}

}  // namespace rc10::client
