#include "web/token.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"
#include "client/page_token.hpp"

namespace rc10::web {

Result<std::string> readOrMakeToken(const std::string& path) {
  auto existing = client::readPageToken(path);
  if (!existing) return tl::unexpected(existing.error());
  if (auto& known = *existing) return std::move(*known);
  auto token = client::makePageToken();
  if (!token) return token;
  const UniqueFd made{
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR)};
  const auto line = *token + "\n";
  if (!made || ::write(made.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    return fail("the token in " + path + " cannot be written: " + errnoText(errno) +
                ". Choose another file with --token-file");
  return token;
}

}  // namespace rc10::web
