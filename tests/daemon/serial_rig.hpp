#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/devices/serial_reviver.hpp"
#include "daemon/devices/serial_writer.hpp"
#include "daemon/temp_dir.hpp"
#include "daemon/threads/rx_loop.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/pty.hpp"

namespace rc10::test {

/// Keeps what it was given.
class RecordingProtocol final : public I_Protocol {
 public:
  RecordingProtocol() { bytes.reserve(1U << 20U); }
  void parse_stream(std::span<const std::uint8_t> more, MonotonicTime received) noexcept override {
    bytes.insert(bytes.end(), more.begin(), more.end());
    times.push_back(received);
  }
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> /*payload*/,
                                       std::span<std::uint8_t> /*out*/) const noexcept override {
    return 0;
  }
  void restart() noexcept override { ++restarts; }

  std::vector<std::uint8_t> bytes;
  std::vector<MonotonicTime> times;
  int restarts = 0;
};

/// One serial device whose adapter can be pulled and plugged in: a pseudo terminal behind a steady name, as
/// under /dev/serial/by-id. RX loop, io thread's part and scheduler's part on one thread.
class SerialRig {
 public:
  void plugIn() {
    pty.emplace();
    std::filesystem::remove(path);
    std::filesystem::create_symlink(pty->path(), path);
  }
  /// As udev does: the name goes with the device.
  void pull() {
    std::filesystem::remove(path);
    pty->unplug();
  }

  void check(Duration later = {}) { reviver.check(now += later); }
  [[nodiscard]] SerialReviver::Watch watch() const {
    return [loop = rx.get()](std::size_t index) { return loop->watchSerial(index); };
  }

  /// Lets the RX loop run until `done`. A pseudo terminal hands bytes over in its own time.
  [[nodiscard]] bool pump(const std::function<bool()>& done) {
    for (int i = 0; i < 200 && !done(); ++i) {
      rx->poll(std::chrono::milliseconds{50});
      deliver(channel, device);
    }
    return done();
  }
  [[nodiscard]] bool pumpUntilGone() {
    return pump([&] { return channel.state.load() == SerialState::kAbsent; });
  }

  /// The texts of the events since the last call.
  std::vector<std::string> events() {
    std::vector<std::string> texts;
    exchange.notes.consume_all([&](const link::Event& note) { texts.emplace_back(note.text.view()); });
    return texts;
  }

  TempDir folder;
  std::string path = folder.path() + "/usb-imu";
  std::optional<Pty> pty;
  std::unique_ptr<SerialChannels> channels =
      SerialChannels::create(std::vector<SerialChannel::Settings>{{"imu", path}}).value();
  SerialChannel& channel = (*channels)[0];
  std::unique_ptr<Robot> robot = Robot::build(twoWheelsAndYaw()).value();
  std::array<BusInbox, kMaxBuses> inboxes;
  LinkExchange exchange;
  std::unique_ptr<RxLoop> rx = RxLoop::create(channels.get()).value();
  SerialReviver reviver{*channels, watch(), exchange};
  SerialWriter writer{*channels};
  SerialDevice device{"imu", std::make_unique<RecordingProtocol>(), channel.outbox};
  RecordingProtocol& protocol = static_cast<RecordingProtocol&>(device.protocol());
  MonotonicTime now{std::chrono::hours{1}};
};

}  // namespace rc10::test
