#include "blackbox/box_file.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>

#include "app/errno_text.hpp"
#include "blackbox/file_bytes.hpp"

namespace rc10::blackbox {
namespace {

// Four seconds of eight motors at 1 kHz, the longest pause of the io thread.
constexpr std::uint64_t kRingBytes = std::uint64_t{1} << 20U;

[[nodiscard]] Error trouble(const std::string& path, const std::string& why) { return {path + ": " + why}; }

[[nodiscard]] bool inMemory(int fd) noexcept {
  struct statfs info {};
  if (::fstatfs(fd, &info) != 0) return false;
  return info.f_type == TMPFS_MAGIC || info.f_type == RAMFS_MAGIC;
}

}  // namespace

Result<std::unique_ptr<BoxFile>> BoxFile::create(const std::string& path, Header header,
                                                 std::uint64_t bytes) {
  header.file_bytes = bytes;
  header.ring_offset = kRingOffset;
  header.ring_bytes = std::min(kRingBytes, bytes / 4);
  header.history_offset = header.ring_offset + header.ring_bytes;
  header.history_bytes = header.file_bytes - header.history_offset;

  const std::string temporary = path + ".new";
  UniqueFd fd{::open(temporary.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640)};
  if (!fd) return tl::unexpected(trouble(temporary, errnoText(errno)));
  const auto give_up = [&](const std::string& why) {
    (void)::unlink(temporary.c_str());
    return tl::unexpected(trouble(temporary, why));
  };
  // Now, so that nothing can lack room later. Not ftruncate(): a hole in a mapped file ends in SIGBUS.
  if (const int error = ::posix_fallocate(fd.get(), 0, static_cast<off_t>(bytes)); error != 0) {
    return give_up(errnoText(error));
  }
  const std::size_t mapped = header.history_offset;
  const bool shared = inMemory(fd.get());
  void* const memory =
      shared ? ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_SHARED, fd.get(), 0)
             : ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return give_up(errnoText(errno));
  auto guard = std::make_unique<CutFileGuard>();
  if (shared && !guard->watch(memory, mapped)) {
    (void)::munmap(memory, mapped);
    return give_up("no handler of SIGBUS could be installed");
  }
  std::memset(memory, 0, mapped);  // every page is there before the first tick
  auto* const head = ::new (memory) FileHead{header, {}};
  std::unique_ptr<BoxFile> box(new BoxFile(path, std::move(fd), head, mapped, shared, std::move(guard)));
  if (auto written =
          writeAll(box->descriptor(), 0, {reinterpret_cast<const std::byte*>(box->head_), sizeof(FileHead)});
      !written) {
    return give_up(written.error().message);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) return give_up(errnoText(errno));
  return box;
}

BoxFile::BoxFile(std::string path, UniqueFd fd, FileHead* head, std::size_t mapped, bool shared,
                 std::unique_ptr<CutFileGuard> guard) noexcept
    : path_(std::move(path)),
      fd_(std::move(fd)),
      head_(head),
      mapped_(mapped),
      file_bytes_(head->header.file_bytes),
      ring_offset_(head->header.ring_offset),
      ring_bytes_(head->header.ring_bytes),
      shared_(shared),
      guard_(std::move(guard)) {}

BoxFile::~BoxFile() {
  guard_.reset();
  (void)::munmap(head_, mapped_);
}

bool BoxFile::whole() noexcept {
  struct stat info {};
  const bool whole = !guard_->replaced() && ::fstat(fd_.get(), &info) == 0 &&
                     info.st_size >= static_cast<off_t>(file_bytes_);
  // The next write to its end would give it its size again, and not what was in it.
  if (!whole) cut_.store(true, std::memory_order_relaxed);
  return !cut_.load(std::memory_order_relaxed);
}

std::span<std::byte> BoxFile::ring() noexcept {
  return {reinterpret_cast<std::byte*>(head_) + ring_offset_, ring_bytes_};
}

Result<void> BoxFile::end() {
  std::atomic_ref(head_->control.ended).store(1, std::memory_order_release);
  if (whole()) return publish();
  const std::uint64_t ended = 1;
  return writeAll(fd_.get(), offsetof(FileHead, control) + offsetof(Control, ended),
                  {reinterpret_cast<const std::byte*>(&ended), sizeof ended});
}

Result<void> BoxFile::publish() {
  if (shared_) return {};
  Control control = head_->control;
  control.head = control.tail;  // the file lacks the bytes of the ring
  control.dropped = std::atomic_ref(head_->control.dropped).load(std::memory_order_relaxed);
  return writeAll(fd_.get(), offsetof(FileHead, control),
                  {reinterpret_cast<const std::byte*>(&control), sizeof control});
}

}  // namespace rc10::blackbox
