#include "web/recordings.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>
#include <system_error>
#include <tuple>
#include <utility>

#include "app/errno_text.hpp"
#include "blackbox/copies.hpp"
#include "web/frame_writer.hpp"

namespace rc10::web {
namespace {

namespace fs = std::filesystem;

// The second waits for the next start of rc10d where copies have no folder.
constexpr std::array<std::string_view, 2> kEndings{".blackbox", ".blackbox.crashed"};
// Half of what a page may be behind before it gets fewer pictures.
constexpr std::size_t kPieceBytes = std::size_t{128} << 10U;
static_assert(kPieceBytes >= blackbox::ImageReader::kLeastPiece);

bool isRecording(std::string_view name) {
  return std::any_of(kEndings.begin(), kEndings.end(), [&](auto ending) { return name.ends_with(ending); });
}

// Both folders may be one, which then has the recordings that run and the copies.
void addOf(const std::string& folder, bool live, bool shared, std::vector<RecordingFile>& files) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    auto name = entry->path().filename().string();
    struct stat status {};
    if (shared && blackbox::isCopy(name) == live) continue;
    if (!isRecording(name) || ::lstat(entry->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode))
      continue;
    const auto changed_us = static_cast<std::int64_t>(status.st_mtim.tv_sec) * 1'000'000 +
                            static_cast<std::int64_t>(status.st_mtim.tv_nsec) / 1000;
    files.push_back({std::move(name), changed_us, live});
  }
}

}  // namespace

Recordings::Recordings(std::string run_dir, std::string state_dir)
    : run_dir_(std::move(run_dir)), state_dir_(std::move(state_dir)) {}

std::vector<RecordingFile> Recordings::list() const {
  std::vector<RecordingFile> files;
  std::error_code none;
  const bool shared = fs::equivalent(run_dir_, state_dir_, none);
  addOf(run_dir_, true, shared, files);
  addOf(state_dir_, false, shared, files);
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return std::tie(b.live, b.changed_us, a.name) < std::tie(a.live, a.changed_us, b.name);
  });
  if (files.size() > kMost) files.resize(kMost);
  return files;
}

Result<OpenRecording> Recordings::open(std::string_view name) const {
  const auto files = list();
  const auto file =
      std::find_if(files.begin(), files.end(), [&](const auto& one) { return one.name == name; });
  if (file == files.end()) return fail("there is no such recording any more: newer ones took its place");
  const auto path = (file->live ? run_dir_ : state_dir_) + "/" + file->name;
  UniqueFd fd{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)};
  if (!fd) return fail(path + ": " + errnoText(errno));
  auto reader = blackbox::ImageReader::open(fd.get());
  if (!reader) return fail(path + ": " + reader.error().message);
  return OpenRecording{std::move(fd), *reader};
}

Result<std::vector<std::byte>> pieceFrame(blackbox::ImageReader& reader, std::uint32_t number, bool& last) {
  std::vector<std::byte> frame(kFrameHeaderBytes + kPieceBytes);
  const auto piece = reader.next(std::span{frame}.subspan(kFrameHeaderBytes));
  if (!piece) return tl::unexpected(piece.error());
  last = piece->offset == 0;
  frame.resize(kFrameHeaderBytes + piece->bytes.size());
  const auto put = [&frame](std::size_t at, auto value) {
    std::memcpy(frame.data() + at, &value, sizeof value);
  };
  put(0, kFrameVersion);
  put(1, FrameKind::kRecording);
  put(4, static_cast<std::uint32_t>(piece->bytes.size()));
  put(8, number);
  put(16, static_cast<double>(piece->offset));
  put(24, static_cast<double>(reader.fileBytes()));
  return frame;
}

}  // namespace rc10::web
