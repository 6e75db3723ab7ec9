#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bus/frame_scanner.hpp"
#include "bus/i_protocol.hpp"
#include "bus/serial_format.hpp"

namespace rc10 {

/// The function codes that this master knows.
enum class ModbusFunction : std::uint8_t {
  kReadHolding = 0x03,
  kReadInput = 0x04,
  kWriteSingle = 0x06,
  kWriteMultiple = 0x10,
};

/// A question to a slave.
struct ModbusRequest {
  std::uint8_t address = 1;  ///< 1 to 247; 0: all of them, which may be written only, and nobody answers.
  ModbusFunction function = ModbusFunction::kReadHolding;
  std::uint16_t first = 0;                  ///< Register, counted from 0.
  std::uint16_t count = 1;                  ///< Registers to read.
  std::span<const std::uint16_t> values{};  ///< Registers to write.
};

enum class ModbusState : std::uint8_t {
  kIdle,       ///< Nothing was asked yet.
  kWaiting,    ///< For the answer.
  kDone,       ///< Answered; what was read is in values().
  kException,  ///< The slave refused: exceptionCode().
  kTimedOut,
};

struct ModbusCounters {
  std::uint64_t requests = 0;
  std::uint64_t answers = 0;
  std::uint64_t exceptions = 0;
  std::uint64_t timeouts = 0;
};

/// A Modbus RTU master: one question at a time. Source: MODBUS over Serial Line V1.02.
///
///   std::array<std::uint8_t, ModbusRtu::kLongestFrame> frame;
///   if (const auto size = modbus.begin({.address = 1, .first = 0, .count = 2}, now, 50ms, frame)) {
///     device.send(std::span(frame).first(size));
///   }
///   ... in each later tick: modbus.update(now), then look at modbus.state()
class ModbusRtu final : public I_Protocol {
 public:
  static constexpr std::size_t kLongestFrame = 256;
  static constexpr std::size_t kMostRead = 125;
  static constexpr std::size_t kMostWritten = 123;

  /// `frame_gap`: the silence between two frames, frameGap() of the line's format.
  explicit ModbusRtu(Duration frame_gap = std::chrono::microseconds{1750}) noexcept : frame_gap_(frame_gap) {}

  /// 3.5 bytes, but 1.75 ms above 19200 baud.
  [[nodiscard]] static Duration frameGap(const SerialFormat& format) noexcept;

  /// Begins a question: writes its frame to `out` and returns the length. 0, and nothing has begun: another
  /// one waits for its answer, the line was not silent for a frame gap, the question is not allowed, or `out`
  /// is too short. The answer has to be there at `now` + `timeout`.
  [[nodiscard]] std::size_t begin(const ModbusRequest& request, MonotonicTime now, Duration timeout,
                                  std::span<std::uint8_t> out) noexcept;
  /// Gives up a question whose time is over.
  void update(MonotonicTime now) noexcept;

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// `payload` is address, function and data; the checksum follows.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  /// The question under way is given up: its answer does not come any more.
  void restart() noexcept override;

  [[nodiscard]] ModbusState state() const noexcept { return state_; }
  /// Registers of the latest successful read; they stay until the next one.
  [[nodiscard]] std::span<const std::uint16_t> values() const noexcept {
    return {values_.data(), value_count_};
  }
  /// When the latest answer ended, of whatever kind; meaningless before the first.
  [[nodiscard]] MonotonicTime answered() const noexcept { return answered_; }
  /// 1 function, 2 address, 3 value, 4 failure, ...; meaningful in kException.
  [[nodiscard]] std::uint8_t exceptionCode() const noexcept { return exception_code_; }
  [[nodiscard]] const ModbusCounters& modbusCounters() const noexcept { return modbus_counters_; }

 private:
  [[nodiscard]] ScanVerdict judge(std::span<const std::uint8_t> shown) const noexcept;
  [[nodiscard]] bool matches(std::span<const std::uint8_t> shown) const noexcept;
  [[nodiscard]] std::size_t answerLength(std::span<const std::uint8_t> shown) const noexcept;
  void take(std::span<const std::uint8_t> answer, MonotonicTime received) noexcept;

  Duration frame_gap_;
  FrameScanner<kLongestFrame> scanner_;
  ModbusState state_ = ModbusState::kIdle;
  // State of the question under way.
  std::array<std::uint8_t, 6>
      head_{};  // address, function, first register, count or value: as a write is answered
  std::uint16_t count_ = 0;
  MonotonicTime deadline_;
  MonotonicTime quiet_from_;

  std::array<std::uint16_t, kMostRead> values_{};
  std::size_t value_count_ = 0;
  MonotonicTime answered_;
  std::uint8_t exception_code_ = 0;
  ModbusCounters modbus_counters_;
};

}  // namespace rc10
