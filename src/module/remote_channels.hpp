#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/time.hpp"
#include "bus/i_protocol.hpp"
#include "bus/serial_format.hpp"

namespace rc10 {

/// A receiver of a remote control as named channels, whatever its protocol. Sticks are -1 to 1, switches -1
/// (down), 0 and 1 (up), keys and buttons 0 or 1.
class RemoteChannels {
 public:
  RemoteChannels() = default;
  RemoteChannels(const RemoteChannels&) = delete;
  RemoteChannels& operator=(const RemoteChannels&) = delete;
  virtual ~RemoteChannels() = default;

  /// "dbus" or "sbus"; null: there is no such protocol.
  [[nodiscard]] static std::unique_ptr<RemoteChannels> make(std::string_view protocol);

  [[nodiscard]] virtual const std::vector<std::string>& names() const noexcept = 0;
  [[nodiscard]] virtual SerialFormat format() const noexcept = 0;
  /// Once: for the port. The channels go on reading it.
  [[nodiscard]] virtual std::unique_ptr<I_Protocol> takeProtocol() = 0;

  /// Silence of the remote itself; Duration::max() if nothing ever has.
  [[nodiscard]] virtual Duration age(MonotonicTime now) const noexcept = 0;
  /// The receiver says that it has lost its remote.
  [[nodiscard]] virtual bool saysLost() const noexcept = 0;
  /// Change of a channel that one frame alone may show, in the unit of read(); 0: none, of a switch or a key.
  [[nodiscard]] virtual double tolerance(std::size_t channel) const noexcept = 0;
  /// The newest value of each channel, in the order of names().
  virtual void read(std::span<double> values) const noexcept = 0;
};

}  // namespace rc10
