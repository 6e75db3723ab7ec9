#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <optional>
#include <utility>
#include <vector>

#include <pthread.h>

#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

/// A bounded queue between threads, as many on either side as you like. Its room is allocated at the start.
///
/// trySend() and tryReceive() never wait for the other side, so they are for real-time threads too: what they
/// take is a lock with priority inheritance, held for the moving of one T and no longer. Keep T small.
template <typename T>
class RtosQueue {
 public:
  explicit RtosQueue(std::size_t capacity = 8) : room_(capacity == 0 ? 1 : capacity) {
    pthread_mutexattr_t mutex;
    pthread_mutexattr_init(&mutex);
    pthread_mutexattr_setprotocol(&mutex, PTHREAD_PRIO_INHERIT);
    pthread_mutex_init(&mutex_, &mutex);
    pthread_mutexattr_destroy(&mutex);
    pthread_condattr_t condition;
    pthread_condattr_init(&condition);
    pthread_condattr_setclock(&condition, CLOCK_MONOTONIC);
    pthread_cond_init(&filled_, &condition);
    pthread_cond_init(&emptied_, &condition);
    pthread_condattr_destroy(&condition);
  }
  RtosQueue(const RtosQueue&) = delete;
  RtosQueue& operator=(const RtosQueue&) = delete;
  ~RtosQueue() {
    pthread_cond_destroy(&emptied_);
    pthread_cond_destroy(&filled_);
    pthread_mutex_destroy(&mutex_);
  }

  /// False: it is full, and nothing was sent.
  bool trySend(T item) {
    const Lock lock(mutex_);
    if (size_ == room_.size()) return false;
    push(std::move(item));
    return true;
  }
  /// Empty: there is nothing.
  [[nodiscard]] std::optional<T> tryReceive() {
    const Lock lock(mutex_);
    if (size_ == 0) return std::nullopt;
    return pop();
  }

  /// Waits for room; false: none within `timeout`.
  bool send(T item, Duration timeout) {
    const auto until = deadline(timeout);
    const Lock lock(mutex_);
    while (size_ == room_.size()) {
      if (pthread_cond_timedwait(&emptied_, &mutex_, &until) != 0 && size_ == room_.size()) return false;
    }
    push(std::move(item));
    return true;
  }
  /// Waits for something; empty: nothing came within `timeout`.
  [[nodiscard]] std::optional<T> receive(Duration timeout) {
    const auto until = deadline(timeout);
    const Lock lock(mutex_);
    while (size_ == 0) {
      if (pthread_cond_timedwait(&filled_, &mutex_, &until) != 0 && size_ == 0) return std::nullopt;
    }
    return pop();
  }

  [[nodiscard]] std::size_t size() const {
    const Lock lock(mutex_);
    return size_;
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return room_.size(); }

 private:
  class Lock {
   public:
    explicit Lock(pthread_mutex_t& mutex) : mutex_(mutex) { pthread_mutex_lock(&mutex_); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    ~Lock() { pthread_mutex_unlock(&mutex_); }

   private:
    pthread_mutex_t& mutex_;
  };

  [[nodiscard]] static timespec deadline(Duration timeout) {
    constexpr std::int64_t kNsPerSecond = 1'000'000'000;
    constexpr std::int64_t kForever = std::int64_t{100} * 365 * 86400 * kNsPerSecond;
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t wait = std::min(std::max<std::int64_t>(timeout.count(), 0), kForever);
    const std::int64_t ns = now.tv_nsec + wait % kNsPerSecond;
    return {.tv_sec = now.tv_sec + wait / kNsPerSecond + ns / kNsPerSecond, .tv_nsec = ns % kNsPerSecond};
  }

  void push(T item) {
    room_[(first_ + size_) % room_.size()] = std::move(item);
    ++size_;
    pthread_cond_signal(&filled_);
  }
  [[nodiscard]] std::optional<T> pop() {
    std::optional<T> item = std::exchange(room_[first_], std::nullopt);
    first_ = (first_ + 1) % room_.size();
    --size_;
    pthread_cond_signal(&emptied_);
    return item;
  }

  mutable pthread_mutex_t mutex_{};
  pthread_cond_t filled_{};
  pthread_cond_t emptied_{};
  std::vector<std::optional<T>> room_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace robot_client
}  // namespace rc10
