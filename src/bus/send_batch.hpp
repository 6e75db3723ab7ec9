#pragma once

#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "bus/can_frame.hpp"
#include "bus/frame_bits.hpp"

namespace rc10 {

/// The frames of one tick as the kernel wants them. All headers are set up once and point into the
/// object. Scheduler thread only.
class SendBatch {
 public:
  static constexpr std::size_t kCapacity = 64;

  struct Entry {
    CanFrame frame;  ///< As it was added.
    FrameBits bits;
    std::optional<std::size_t> packer;  ///< Its packer; none: sent on its own.
    bool sent = false;
  };

  SendBatch() noexcept;
  SendBatch(const SendBatch&) = delete;
  SendBatch& operator=(const SendBatch&) = delete;
  ~SendBatch() = default;

  [[nodiscard]] std::size_t room() const noexcept { return kCapacity - size_; }
  [[nodiscard]] std::span<const Entry> entries() const noexcept { return std::span(entries_).first(size_); }

  /// False if the batch is full or there is no such frame.
  bool add(const CanFrame& frame, std::optional<std::size_t> packer) noexcept;

  /// Hands the frames to the kernel in their order and marks what it accepted. Returns where it stopped:
  /// entries().size() if it took all. One system call, except when the kernel refuses a frame for its own
  /// sake.
  std::size_t send(int fd) noexcept;

  /// errno of the last send() in which the kernel took nothing, else 0.
  [[nodiscard]] int error() const noexcept { return error_; }

  void clear() noexcept {
    cleared_ = size_;
    size_ = 0;
  }
  /// The frames before the last clear(). Valid until the next add().
  [[nodiscard]] std::span<const Entry> cleared() const noexcept {
    return std::span(entries_).first(cleared_);
  }

 private:
  std::array<Entry, kCapacity> entries_{};
  std::array<canfd_frame, kCapacity> frames_{};
  std::array<iovec, kCapacity> contents_{};
  std::array<mmsghdr, kCapacity> headers_{};
  std::size_t size_ = 0;
  std::size_t cleared_ = 0;
  int error_ = 0;
};

}  // namespace rc10
