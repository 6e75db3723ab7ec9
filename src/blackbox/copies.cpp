#include "blackbox/copies.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"
#include "blackbox/file_bytes.hpp"
#include "blackbox/image.hpp"

namespace rc10::blackbox {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".blackbox";

[[nodiscard]] bool isDigit(char c) noexcept { return c >= '0' && c <= '9'; }

// After the name of the robot and a dash.
constexpr std::string_view kTimeForm = "00000000T000000Z-";

[[nodiscard]] bool beginsWithTime(std::string_view text) noexcept {
  if (text.size() < kTimeForm.size()) return false;
  for (std::size_t i = 0; i < kTimeForm.size(); ++i) {
    if (kTimeForm[i] == '0' ? !isDigit(text[i]) : text[i] != kTimeForm[i]) return false;
  }
  return true;
}

// Robots 'a' and 'a-b' share a prefix: only a time may follow the name.
[[nodiscard]] bool isCopyOf(std::string_view name, const std::string& robot) {
  return isCopy(name) && name.starts_with(robot + "-") && beginsWithTime(name.substr(robot.size() + 1));
}

[[nodiscard]] Result<void> copyInto(int from, int to, const std::string& cause) {
  const auto write = [to](std::uint64_t offset, std::span<const std::byte> bytes) {
    return writeAll(to, offset, bytes);
  };
  if (auto taken = takeImage(from, write, [&cause](Header& header) { header.cause = cause; }); !taken) {
    return taken;
  }
  if (::fsync(to) != 0) return fail(errnoText(errno));
  return {};
}

}  // namespace

std::string copyName(const std::string& robot, std::int64_t wall_s, const std::string& cause) {
  const auto seconds = static_cast<std::time_t>(wall_s);
  std::tm utc{};
  (void)::gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const auto size = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  return robot + "-" + std::string(text.data(), size) + "-" + cause + std::string(kExtension);
}

bool isCopy(std::string_view name) noexcept {
  if (!name.ends_with(kExtension)) return false;
  name.remove_suffix(kExtension.size());
  for (std::size_t dash = name.find('-'); dash != std::string_view::npos; dash = name.find('-', dash + 1)) {
    if (beginsWithTime(name.substr(dash + 1))) return true;
  }
  return false;
}

Result<std::string> keepCopy(int fd, const std::string& dir, const std::string& robot, std::int64_t wall_s,
                             const std::string& cause) {
  // One name for all, so that what a power cut leaves is overwritten by the next.
  const std::string temporary = dir + "/" + robot + std::string(kExtension) + ".part";
  const std::string path = dir + "/" + copyName(robot, wall_s, cause);
  const UniqueFd folder{::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (!folder) return fail(dir + ": " + errnoText(errno));
  const UniqueFd out{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640)};
  if (!out) return fail(dir + ": " + errnoText(errno));
  auto copied = copyInto(fd, out.get(), cause);
  if (copied && ::rename(temporary.c_str(), path.c_str()) != 0) copied = fail(errnoText(errno));
  if (!copied) {
    (void)::unlink(temporary.c_str());
    return fail(dir + ": " + copied.error().message);
  }
  (void)::fsync(folder.get());  // the name, too
  return path;
}

void removeOldCopies(const std::string& dir, const std::string& robot, std::size_t count) {
  std::vector<std::string> copies;
  std::error_code error;
  for (fs::directory_iterator entry(dir, error), end; !error && entry != end; entry.increment(error)) {
    if (isCopyOf(entry->path().filename().string(), robot)) copies.push_back(entry->path().string());
  }
  if (copies.size() <= count) return;
  std::sort(copies.begin(), copies.end());  // the time in the name makes it that of their age
  copies.resize(copies.size() - count);
  for (const auto& copy : copies) fs::remove(copy, error);
}

}  // namespace rc10::blackbox
