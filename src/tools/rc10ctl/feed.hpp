#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "client/link_client.hpp"
#include "client/module_text.hpp"

namespace rc10::ctl {

/// Receives what was subscribed to and keeps the newest of each.
class Feed {
 public:
  explicit Feed(LinkClient& rc10d);

  /// Takes what has come. Does not wait. False: rc10d has ended.
  [[nodiscard]] bool pump();

  /// The newest state, diagnostics; null: none yet.
  [[nodiscard]] const link::State* state() const noexcept { return state_ ? &*state_ : nullptr; }
  [[nodiscard]] const link::Diagnostics* diagnostics() const noexcept {
    return diagnostics_ ? &*diagnostics_ : nullptr;
  }
  /// The modules, as far as they have told of themselves.
  [[nodiscard]] const std::vector<client::ModuleView>& modules() const noexcept { return modules_; }
  /// When the newest state came.
  [[nodiscard]] MonotonicTime stateTime() const noexcept { return state_time_; }
  /// The events since the last call.
  [[nodiscard]] std::vector<link::Event> takeEvents() noexcept { return std::exchange(events_, {}); }

  /// Waits for the first state or diagnostics, or that of each module. The error says why there is none.
  [[nodiscard]] Result<void> awaitState();
  [[nodiscard]] Result<void> awaitDiagnostics();
  [[nodiscard]] Result<void> awaitModules();

 private:
  void take(std::span<const std::byte> datagram);
  template <typename There>
  [[nodiscard]] Result<void> await(const There& there);

  LinkClient& rc10d_;
  std::vector<std::byte> buffer_;
  std::optional<link::State> state_;
  std::optional<link::Diagnostics> diagnostics_;
  std::vector<client::ModuleView> modules_;
  std::vector<link::Event> events_;
  MonotonicTime state_time_{};
};

}  // namespace rc10::ctl
