#include "web/token.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "app/unique_fd.hpp"
#include "client/page_token.hpp"

namespace rc10::web {
namespace {

Result<std::string> makeToken() {
  // 32 signs: each byte gives one without a bias.
  constexpr std::string_view kSigns = "abcdefghijkmnpqrstuvwxyz23456789";
  static_assert(kSigns.size() == 32);
  std::array<unsigned char, client::kPageTokenLength> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return fail(std::string{"no random numbers: "} + std::strerror(errno));
  std::string token;
  for (const auto byte : random) token += kSigns[byte % kSigns.size()];
  return token;
}

}  // namespace

Result<std::string> readOrMakeToken(const std::string& path) {
  auto existing = client::readPageToken(path);
  if (!existing) return tl::unexpected(existing.error());
  if (*existing) return std::move(**existing);
  auto token = makeToken();
  if (!token) return token;
  const UniqueFd made{
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR)};
  const auto line = *token + "\n";
  if (!made || ::write(made.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    return fail("the token in " + path + " cannot be written: " + std::strerror(errno) +
                ". Choose another file with --token-file");
  return token;
}

}  // namespace rc10::web
