#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/serial_device.hpp"
#include "fake_robot.hpp"
#include "module/modbus_rtu.hpp"
#include "module/serial_link.hpp"
#include "module/serial_link_field.hpp"
#include "serial_streams.hpp"
#include "support/heard_cobs.hpp"

namespace rc10::test::serial_link_board {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Sink : ByteSink {
  Bytes bytes;
  [[nodiscard]] bool push(std::span<const std::uint8_t> more) noexcept override {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return true;
  }
  std::size_t waiting = 0;
  [[nodiscard]] std::size_t pending() const noexcept override { return waiting; }
};

struct Row {
  std::string name;
  std::string message = {};
  int place = 1;
  int reg = -1;
  std::string type = "f32";
  double scale = 1.0;
  double safe = 0.0;
  double low = -1e9;
  double high = 1e9;
  std::string on_estop = "safe";
  bool input_register = false;
};

inline OwnValues valuesOf(const Row& row, bool sent) {
  OwnValues own;
  own.set("name", row.name);
  if (!row.message.empty()) own.set("message", row.message);
  own.set("place", static_cast<double>(row.place));
  if (row.reg >= 0) own.set("register", static_cast<double>(row.reg));
  own.set("type", row.type);
  own.set("scale", row.scale);
  if (!sent) {
    own.set("input_register", row.input_register ? 1.0 : 0.0);
    return own;
  }
  own.set("safe_value", row.safe);
  own.set("min", row.low);
  own.set("max", row.high);
  own.set("on_estop", row.on_estop);
  return own;
}

inline ModuleSettings settingsOf(const std::string& protocol, const std::vector<Row>& receive,
                                 const std::vector<Row>& send, double rate_hz = 50) {
  ModuleSettings settings;
  settings.name = "board";
  settings.own.set("port", std::string{"/dev/ttyUSB0"});
  settings.own.set("protocol", protocol);
  settings.own.set("baud", 115200.0);
  settings.own.set("format", std::string{"8N1"});
  settings.own.set("rate_hz", rate_hz);
  settings.own.set("max_age_ms", 200.0);
  settings.own.set("address", 3.0);
  settings.own.set("timeout_ms", 50.0);
  settings.own.set("word_order", std::string{"high_first"});
  std::vector<OwnValues> rows;
  for (const auto& row : receive) rows.push_back(valuesOf(row, false));
  settings.own.set("receive", rows);
  rows.clear();
  for (const auto& row : send) rows.push_back(valuesOf(row, true));
  settings.own.set("send", rows);
  return settings;
}

/// A module with its port, and the board at the other end.
class Board {
 public:
  explicit Board(const ModuleSettings& settings)
      : module_(std::move(serialLinkType().build(settings, outlineOf(1)).value())) {
    auto need = module_->takeSerialNeed();
    device_ = std::make_unique<SerialDevice>("board", std::move(need->protocol), sink_);
    module_->useSerial(*device_);
    device_->setState(SerialState::kOpen);
  }

  void run(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      robot_.update(*module_);
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
    }
  }
  void hear(std::string_view text) { hear(Bytes{text.begin(), text.end()}); }
  void hear(const Bytes& bytes) { device_->protocol().parse_stream(bytes, robot_.now()); }
  void command(std::initializer_list<double> values) {
    const std::vector<double> inputs{values};
    module_->setInputs(inputs);
  }
  /// The bytes sent since the last call.
  [[nodiscard]] std::string said() {
    const auto bytes = std::exchange(sink_.bytes, {});
    return {bytes.begin(), bytes.end()};
  }
  [[nodiscard]] Bytes saidBytes() { return std::exchange(sink_.bytes, {}); }
  [[nodiscard]] double output(std::string_view name) const {
    const auto& names = module_->signals().outputs;
    const auto found = std::find(names.begin(), names.end(), name);
    return module_->outputs()[static_cast<std::size_t>(found - names.begin())];
  }
  [[nodiscard]] FakeRobot& robot() { return robot_; }
  /// Bytes that the line has not taken yet.
  void jam(std::size_t bytes) { sink_.waiting = bytes; }
  void rest(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now_ += 1ms;
      module_->rest({.index = 0, .now = robot_.now() + now_, .dt_s = 0.001F});
    }
  }
  [[nodiscard]] SerialDevice& device() { return *device_; }
  [[nodiscard]] std::vector<std::size_t> takeEvents() { return std::exchange(events_, {}); }

 private:
  Sink sink_;
  FakeRobot robot_{1};
  std::unique_ptr<Module_Base> module_;
  std::unique_ptr<SerialDevice> device_;
  std::vector<std::size_t> events_;
  Duration now_{};
};

/// "$range,1250*29\n" of "range,1250".
inline std::string line(const std::string& content) {
  unsigned sum = 0;
  for (const char c : content) sum ^= static_cast<unsigned char>(c);
  constexpr std::string_view kHex = "0123456789ABCDEF";
  return "$" + content + "*" + kHex[sum / 16] + kHex[sum % 16] + "\n";
}

inline ModuleSettings textLink() {
  return settingsOf("text",
                    {{.name = "range_m", .message = "range", .scale = 0.001},
                     {.name = "load_a", .message = "power", .place = 2}},
                    {{.name = "claw_deg", .message = "claw", .low = 0, .high = 90},
                     {.name = "claw_speed", .message = "claw", .place = 2, .safe = 1.0},
                     {.name = "lamp", .message = "lamp", .scale = 2.0, .on_estop = "keep"}});
}

}  // namespace rc10::test::serial_link_board
