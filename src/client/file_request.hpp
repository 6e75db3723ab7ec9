#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10::client {

/// Where systemd listens for rc10-config, on a robot that allows it.
inline constexpr const char* kFileSocket = "/run/rc10-config.socket";

enum class FileVerb : std::uint8_t { kCheck, kInstall, kRestart };
[[nodiscard]] const char* toString(FileVerb verb) noexcept;

/// A request to rc10-config about the file of one robot: one datagram, "VERB ROBOT HASH" in its first line,
/// the text in all others.
struct FileRequest {
  static constexpr std::size_t kMostTextBytes = std::size_t{128} << 10U;
  static constexpr std::size_t kMostBytes = kMostTextBytes + 256;

  FileVerb verb{};
  std::string robot;     ///< As rc10d calls it, or the name of its file.
  std::string replaces;  ///< SHA-256 of the file that the text replaces; empty: whatever is there.
  std::string text;      ///< Empty for a restart.
};
[[nodiscard]] Result<std::string> bytesOf(const FileRequest& request);
[[nodiscard]] Result<FileRequest> parseFileRequest(std::string_view bytes);

/// "done" or "refused" in its first line, words for people in all others.
struct FileAnswer {
  static constexpr std::size_t kMostBytes = std::size_t{64} << 10U;
  bool done = false;
  std::string message;
};
[[nodiscard]] std::string bytesOf(const FileAnswer& answer);
[[nodiscard]] Result<FileAnswer> parseFileAnswer(std::string_view bytes);

/// One request to rc10-config, under way. Nothing here waits.
class FileCall {
 public:
  /// A restart takes as long as rc10d's end and start may.
  static constexpr Duration kPatience = std::chrono::seconds{30};

  [[nodiscard]] static Result<FileCall> send(const FileRequest& request, MonotonicTime now,
                                             const std::string& socket_path = kFileSocket);

  /// For poll().
  [[nodiscard]] int descriptor() const noexcept { return socket_.get(); }
  /// The answer, once; none: it is not there yet.
  [[nodiscard]] std::optional<Result<FileAnswer>> poll(MonotonicTime now);

 private:
  FileCall(UniqueFd socket, MonotonicTime deadline) : socket_(std::move(socket)), deadline_(deadline) {}

  UniqueFd socket_;
  MonotonicTime deadline_;
};

}  // namespace rc10::client
