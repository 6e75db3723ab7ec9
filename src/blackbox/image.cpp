#include "blackbox/image.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>

#include "app/errno_text.hpp"
#include "app/unique_fd.hpp"
#include "blackbox/file_bytes.hpp"

namespace rc10::blackbox {
namespace {

constexpr std::size_t kReadAtOnce = std::size_t{64} * 1024;
static_assert(kReadAtOnce >= ImageReader::kLeastPiece);

template <typename T>
[[nodiscard]] Result<void> readObject(int fd, std::uint64_t offset, T& out) {
  return readAll(fd, offset, {reinterpret_cast<std::byte*>(&out), sizeof out});
}

// A word that another process may be writing. pread() does not promise to read eight bytes at once: two
// equal readings do.
[[nodiscard]] Result<std::uint64_t> readWord(int fd, std::size_t offset_in_control) {
  const std::uint64_t offset = offsetof(FileHead, control) + offset_in_control;
  std::uint64_t word = 0;
  std::uint64_t again = 0;
  do {
    if (auto read = readObject(fd, offset, word); !read) return tl::unexpected(read.error());
    if (auto read = readObject(fd, offset, again); !read) return tl::unexpected(read.error());
  } while (word != again);
  return word;
}

}  // namespace

Result<void> checkHeader(const Header& header) {
  if (header.magic != kMagic) return fail("this is no black box of rc10d");
  if (header.version != kFormatVersion) {
    return fail("it was written by another version of rc10d (format " + std::to_string(header.version) +
                ", this program reads " + std::to_string(kFormatVersion) + ")");
  }
  const bool power_of_two = header.ring_bytes != 0 && (header.ring_bytes & (header.ring_bytes - 1)) == 0;
  const bool fits = header.file_bytes <= kMaxFileBytes && header.ring_offset >= sizeof(FileHead) &&
                    header.ring_offset <= kMaxFileBytes && header.ring_bytes <= kMaxFileBytes &&
                    header.history_offset == header.ring_offset + header.ring_bytes &&
                    header.history_bytes <= kMaxFileBytes && header.history_bytes > 0 &&
                    header.history_offset + header.history_bytes == header.file_bytes &&
                    header.bus_count <= header.buses.size() && header.motor_count <= header.motors.size() &&
                    header.module_count <= header.modules.size();
  if (!power_of_two || !fits) return fail("its header is damaged");
  return {};
}

ImageReader::ImageReader(int fd, const Header& header, std::uint64_t end) noexcept
    : fd_(fd),
      history_offset_(header.history_offset),
      file_bytes_(header.file_bytes),
      end_(end),
      at_(header.ring_offset) {}

Result<ImageReader> ImageReader::open(int fd) {
  FileHead head;
  if (auto read = readObject(fd, 0, head); !read) return fail("this is no black box of rc10d");
  const auto& header = head.header;
  if (auto checked = checkHeader(header); !checked) return tl::unexpected(checked.error());
  struct stat info {};
  if (::fstat(fd, &info) != 0) return fail(errnoText(errno));
  if (static_cast<std::uint64_t>(info.st_size) < header.file_bytes) {
    return fail("it is cut off: it has " + std::to_string(info.st_size) + " of " +
                std::to_string(header.file_bytes) + " bytes");
  }
  const auto end = readWord(fd, offsetof(Control, head));
  if (!end) return tl::unexpected(end.error());
  return ImageReader{fd, header, *end};
}

// The order makes it whole. The scheduler can overwrite of the ring only what was before `tail`, so what was
// read of it before `tail` is good from `tail` on. The io thread moves `oldest` before it overwrites, so what
// was read of the history before `oldest` is good from `oldest` on.
Result<ImageReader::Piece> ImageReader::next(std::span<std::byte> buffer) {
  if (at_ == file_bytes_) return beginning(buffer);
  if (at_ == history_offset_) {
    const auto tail = readWord(fd_, offsetof(Control, tail));
    if (!tail) return tl::unexpected(tail.error());
    tail_ = *tail;
  }
  const auto end = at_ < history_offset_ ? history_offset_ : file_bytes_;
  const auto piece = buffer.first(std::min<std::uint64_t>(buffer.size(), end - at_));
  if (auto read = readAll(fd_, at_, piece); !read) return tl::unexpected(read.error());
  return Piece{std::exchange(at_, at_ + piece.size()), piece};
}

Result<ImageReader::Piece> ImageReader::beginning(std::span<std::byte> buffer) {
  const auto head = buffer.first(sizeof(FileHead));
  if (auto read = readAll(fd_, 0, head); !read) return tl::unexpected(read.error());
  const auto oldest = readWord(fd_, offsetof(Control, oldest));
  if (!oldest) return tl::unexpected(oldest.error());
  Control control;
  const auto place = head.subspan(offsetof(FileHead, control));
  std::memcpy(&control, place.data(), sizeof control);
  control.head = std::max(end_, tail_);
  control.tail = tail_;
  // Ahead of the end: it took so long that all of it was overwritten.
  control.oldest = std::min(*oldest, control.head);
  std::memcpy(place.data(), &control, sizeof control);
  return Piece{0, head};
}

Result<void> takeImage(int fd, const Sink& sink, const std::function<void(Header&)>& amend) {
  auto reader = ImageReader::open(fd);
  if (!reader) return tl::unexpected(reader.error());
  std::vector<std::byte> buffer(kReadAtOnce);
  for (;;) {
    const auto piece = reader->next(buffer);
    if (!piece) return tl::unexpected(piece.error());
    if (piece->offset == 0 && amend) {
      const auto header = std::make_unique<Header>();
      std::memcpy(header.get(), buffer.data(), sizeof(Header));
      amend(*header);
      std::memcpy(buffer.data(), header.get(), sizeof(Header));
    }
    if (auto taken = sink(piece->offset, piece->bytes); !taken || piece->offset == 0) return taken;
  }
}

Result<std::vector<std::byte>> readImage(const std::string& path) {
  const UniqueFd fd{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (!fd) return fail(path + ": " + errnoText(errno));
  std::vector<std::byte> image;
  const auto keep = [&image](std::uint64_t offset, std::span<const std::byte> bytes) -> Result<void> {
    if (image.size() < offset + bytes.size()) image.resize(offset + bytes.size());
    std::memcpy(image.data() + offset, bytes.data(), bytes.size());
    return {};
  };
  if (auto taken = takeImage(fd.get(), keep); !taken) return fail(path + ": " + taken.error().message);
  return image;
}

}  // namespace rc10::blackbox
