#include "web/token.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "app/unique_fd.hpp"

namespace rc10::web {
namespace {

constexpr std::size_t kTokenLength = 32;

Result<std::string> makeToken() {
  // 32 signs: each byte gives one without a bias.
  constexpr std::string_view kSigns = "abcdefghijkmnpqrstuvwxyz23456789";
  static_assert(kSigns.size() == 32);
  std::array<unsigned char, kTokenLength> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return fail(std::string{"no random numbers: "} + std::strerror(errno));
  std::string token;
  for (const auto byte : random) token += kSigns[byte % kSigns.size()];
  return token;
}

bool isToken(std::string_view text) {
  return text.size() == kTokenLength && std::all_of(text.begin(), text.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0;
         });
}

Result<std::string> cannot(const std::string& path, const char* what) {
  return fail("the token in " + path + " " + what + ": " + std::strerror(errno) +
              ". Choose another file with --token-file");
}

Result<std::string> readToken(int file, const std::string& path) {
  struct stat status {};
  if (::fstat(file, &status) != 0) return cannot(path, "cannot be read");
  if (!S_ISREG(status.st_mode) || (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return fail(path + " is open to others than its owner: `chmod 600 " + path +
                "`, or remove it for a new token");
  std::array<char, kTokenLength + 2> bytes{};
  const auto size = ::read(file, bytes.data(), bytes.size());
  if (size < 0) return cannot(path, "cannot be read");
  std::string_view text{bytes.data(), static_cast<std::size_t>(size)};
  if (text.ends_with('\n')) text.remove_suffix(1);
  if (!isToken(text)) return fail(path + " holds no token: remove it, and a new one is made");
  return std::string{text};
}

}  // namespace

Result<std::string> readOrMakeToken(const std::string& path) {
  const UniqueFd existing{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)};
  if (existing) return readToken(existing.get(), path);
  if (errno != ENOENT) return cannot(path, "cannot be read");
  auto token = makeToken();
  if (!token) return token;
  const UniqueFd made{
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR)};
  const auto line = *token + "\n";
  if (!made || ::write(made.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    return cannot(path, "cannot be written");
  return token;
}

}  // namespace rc10::web
